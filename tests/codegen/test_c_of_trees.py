"""C of closed machines and of robots that are no planar chain: torques, loops that do not close, laws."""

from __future__ import annotations

import numpy as np
import pytest
from closed_machines import cylinder_knee, four_bar_knee, two_rod_ankle
from compiled import CompiledLeg, made_up, needs_compiler, source_of
from compiled_laws import compile_laws, records
from laws_of_bleex import torques_in_python
from planar_chains import assert_relative

import exoid
from exoid import Armature, Coulomb, Viscous
from exoid.codegen import c_source
from exoid.control import computed_torque, gravity_friction_pd
from exoid.leg.description import describe

pytestmark = [needs_compiler, pytest.mark.slow]

EXACT, SINGLE = 1e-12, 2e-5
"""Largest error allowed in double and in float, relative to the largest entry."""

CLOSED = {
    "four-bar knee": (four_bar_knee, 0.3),
    "two-rod ankle": (two_rod_ankle, 0.3),
    "cylinder": (cylinder_knee, 0.04),
}
"""Closed machines, with the range of their joints [rad or m]."""

TERMS = (Coulomb(), Viscous(), Armature())


def skew_arm():
    """CUHK's leg with a hip that abducts."""
    text = exoid.load_leg("cuhk").description.text
    skew = text.replace('<axis xyz="0.0 1.0 0.0" />', '<axis xyz="0.6 0.0 0.8" />', 1)
    return exoid.Leg.from_description(describe(skew, name="skew.urdf"), ("left_hip", "left_knee"))


@pytest.fixture(params=[*CLOSED, "skew axes", "two legs"], scope="module")
def case(request, tmp_path_factory):
    """A robot and the range of its joints."""
    if request.param in CLOSED:
        make, reach = CLOSED[request.param]
        return make(0).leg(tmp_path_factory.mktemp("machine")), reach
    return (skew_arm() if request.param == "skew axes" else exoid.load_exo("cuhk")), 1.0


def motion(leg, reach):
    rng = np.random.default_rng(1)
    q, v, a = rng.uniform(-1.0, 1.0, (3, 40, len(leg.joint_names))) * [[[reach]], [[4.0 * reach]], [[20.0 * reach]]]
    return (q if leg.closure is None else leg.closure.reachable(q)), v, a


@pytest.mark.parametrize(("precision", "tolerance"), [("double", EXACT), ("float", SINGLE)])
def test_every_function_is_that_of_python(case, precision, tolerance, tmp_path):
    leg, reach = case
    estimate = made_up(leg, TERMS)
    c = CompiledLeg(source_of(estimate, precision=precision), tmp_path)
    q, v, a = motion(leg, reach)
    assert_relative(c("inverse_dynamics", q, v, a), estimate.torque(q, v, a), tolerance)
    assert_relative(c("rigid_bodies", q, v, a), leg.inverse_dynamics(q, v, a), tolerance)
    assert_relative(c("gravity", q), leg.gravity(q), tolerance)
    M, rest = c.mass_matrix(q), c("inverse_dynamics", q, 0.0 * v, 0.0 * a)
    assert np.array_equal(M, M.swapaxes(1, 2))
    assert_relative(np.einsum("kij,kj->ki", M, a), estimate.torque(q, 0.0 * v, a) - rest, tolerance)


def test_poses_that_do_not_close_have_no_torque_in_c(tmp_path):
    """As in Python, also beyond a dead centre, and for angles that are no numbers."""
    leg = four_bar_knee(0).leg(tmp_path)
    c = CompiledLeg(source_of(made_up(leg, ())), tmp_path)
    poses = np.random.default_rng(0).uniform(-3.0, 3.0, (60, 2))
    closed = np.array([leg.closure.solve(one[None])[1][0] for one in poses])
    assert 10 < closed.sum() < 50
    for name in ("gravity", "mass_matrix"):
        found = c(name, poses, shape=(2, 2) if name == "mass_matrix" else (2,))
        assert np.array_equal(np.isfinite(found.reshape(60, -1)).all(axis=1), closed)
    assert not np.isfinite(c("gravity", [[np.nan, 0.0], [0.0, np.inf], [1e300, 0.0]])).any()


def test_laws_of_a_closed_leg_are_those_of_python(tmp_path):
    leg = four_bar_knee(0).leg(tmp_path)
    estimate = made_up(leg, TERMS)
    estimate = made_up(leg, TERMS, values=np.abs(estimate.values) * np.sign([*leg.parameters, *[1.0] * 5]))
    kp, kd = np.array([20.0, 30.0]), np.array([2.0, 3.0])
    laws = {"support": gravity_friction_pd(estimate, kp, kd), "torque": computed_torque(estimate, kp, kd)}
    sources = [c_source(law, name=name) for name, law in laws.items()]
    in_c = compile_laws(sources, tmp_path, ("-O2",))
    q, v, a = motion(leg, 0.3)
    values = {"q": q, "v": v, "q_d": q[::-1], "v_d": v[::-1], "a_d": a}
    for source, law in zip(sources, laws.values(), strict=True):
        tau, status, _ = in_c[source.prefix].run(records(source, len(q), values))
        assert not status.any()
        assert_relative(tau, torques_in_python(law, values, last=np.zeros(2)), EXACT)
