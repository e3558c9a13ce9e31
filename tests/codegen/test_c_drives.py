"""Commands of drives in C are those of Python, and friction of coupled motors too."""

import ctypes

import numpy as np
import pytest
from compiled import CompiledLeg, made_up, needs_compiler
from compiled_laws import compile_laws, records

import exoid
from exoid import Viscous
from exoid.actuators import (
    Actuators,
    Coupling,
    LinearActuator,
    MomentArmTable,
    Motor,
    SeriesElastic,
    motor_terms,
    read_actuators,
)
from exoid.codegen import c_source
from exoid.control import State, gravity_friction_pd, pd
from exoid.rig import Target

LEG = exoid.load_leg("bleex")
MATRIX = ((0.05, 0.06), (0.07, -0.04))
DRIVES = {
    "cylinders": read_actuators("bleex", LEG),
    "mixed": Actuators.of(
        LEG,
        {
            "hip": Motor(0.07, ratio=-50.0, efficiency=0.8, back_efficiency=0.6, max_current=3.0),
            "knee": SeriesElastic(300.0, ratio=40.0),
        },
    ),
    "coupled": Actuators.of(LEG, {"drive": Coupling(("hip", "ankle"), MATRIX)}),
}


@needs_compiler
@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize(("precision", "error"), [("double", 1e-12), ("float", 1e-4)])
def test_commands_are_those_of_python(name, precision, error, tmp_path) -> None:
    rng, estimate = np.random.default_rng(0), made_up(LEG)
    source = c_source(estimate.model, estimate.values, precision=precision, actuators=DRIVES[name])
    assert source.functions[-1] == "leg_command"
    q, v = rng.uniform(LEG.limits.lower, LEG.limits.upper, (50, 3)), 0.1 * rng.normal(size=(50, 3))
    torque = np.vstack([20.0 * rng.normal(size=(49, 3)), np.zeros((1, 3))])
    expected = DRIVES[name].command(torque, q, v)
    found = CompiledLeg(source, tmp_path)("command", q, v, torque)
    np.testing.assert_allclose(found, expected, rtol=error, atol=error * np.abs(expected).max())


@needs_compiler
@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_no_torque_is_no_command_whatever_the_measurement(name, wrong, tmp_path) -> None:
    estimate = made_up(LEG)
    leg = CompiledLeg(c_source(estimate.model, estimate.values, actuators=DRIVES[name]), tmp_path)
    zero, wrong = np.zeros(3), np.full(3, wrong)
    for q, v, torque in ((zero, wrong, zero), (wrong, zero, zero), (wrong, wrong, zero), (zero, zero, wrong)):
        command = leg("command", q, v, torque)[0]
        motor_angle = np.array([unit == "rad" for unit in DRIVES[name].units])
        assert (command[~motor_angle] == 0.0).all()


@needs_compiler
def test_a_torque_is_made_also_while_the_velocity_is_unknown(tmp_path) -> None:
    """The safe torque may hold the leg against gravity then."""
    estimate, torque = made_up(LEG), np.array([[20.0, -10.0, 5.0]])
    leg = CompiledLeg(c_source(estimate.model, estimate.values, actuators=DRIVES["mixed"]), tmp_path)
    at_rest = leg("command", np.zeros(3), np.zeros(3), torque)
    np.testing.assert_array_equal(leg("command", np.zeros(3), np.full(3, np.nan), torque), at_rest)


@needs_compiler
def test_a_law_turns_its_torque_into_commands_of_the_drives(tmp_path) -> None:
    source = c_source(pd((60.0, 40.0, 20.0), 2.0), actuators=DRIVES["mixed"])
    assert source.functions == ("law_init", "law_step", "law_command")
    (law,) = compile_laws([source], tmp_path, ("-O2",)).values()
    q, v, torque, found = *np.random.default_rng(0).normal(size=(3, 3)), np.zeros(3)
    law.library.law_command(*(x.ctypes.data_as(ctypes.c_void_p) for x in (q, v, torque, found)))
    np.testing.assert_allclose(found, DRIVES["mixed"].command(torque[None], q[None], v[None])[0], rtol=1e-12)


@needs_compiler
def test_friction_of_coupled_motors_is_that_of_python(tmp_path) -> None:
    terms = (Viscous(), *motor_terms(Coupling(("hip", "ankle"), MATRIX))[:2])
    estimate = made_up(LEG, terms)
    q, v, a = np.random.default_rng(1).normal(size=(3, 20, 3))
    leg = CompiledLeg(c_source(estimate.model, estimate.values), tmp_path)
    motion = estimate.model.motion(q, v, a)
    friction = estimate.model.columns(motion).T @ np.where(estimate.model.friction, estimate.values, 0.0)
    np.testing.assert_allclose(leg("friction", v), friction, rtol=1e-10)
    np.testing.assert_allclose(leg("inverse_dynamics", q, v, a), estimate.torque(q, v, a), rtol=1e-9)


@needs_compiler
def test_rotors_of_coupled_motors_leave_laws_without_inertia_their_form(tmp_path) -> None:
    motors = motor_terms(Coupling(("hip", "ankle"), MATRIX))
    law = gravity_friction_pd(made_up(LEG, (Viscous(), *motors)), (60.0, 40.0, 20.0), 2.0)
    source = c_source(law)
    (in_c,) = compile_laws([source], tmp_path).values()
    q, v, q_d, v_d = np.random.default_rng(0).normal(size=(4, 3))
    given = records(source, 1, {"q": q, "v": v, "q_d": q_d, "v_d": v_d})
    torque = in_c.run(given)[0][0]
    np.testing.assert_allclose(torque, law.torque(State(q, v), Target(q_d, v_d)), rtol=1e-12)


def test_an_estimate_with_such_drives_is_written_without_commands_and_says_so(tmp_path) -> None:
    table = Actuators.of(LEG, {"hip": LinearActuator(MomentArmTable((-1.0, 0.0, 1.0, 2.0), (0.04,) * 4))})
    written = made_up(LEG, actuators=table).to_c(tmp_path / "leg.c")
    assert "leg_command" not in written.functions
    assert any("no function for commands of the drives" in warning for warning in written.warnings)
    assert made_up(LEG, actuators=DRIVES["mixed"]).to_c(tmp_path / "leg.c").functions[-1] == "leg_command"
