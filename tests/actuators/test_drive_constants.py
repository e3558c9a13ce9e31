"""Torque constants and efficiencies that are not known are found beside the parameters, or refused by name."""

import re
from dataclasses import replace

import numpy as np
import pytest
from made_estimates import from_file
from swings import harmonics
from unchecked import identify

import exoid
from exoid.actuators import Actuators, Attachments, LinearActuator, Motor
from exoid.actuators.drive_data import actuators_from_data, actuators_to_data
from exoid.errors import ExoidError, NotIdentifiableError, NotSupportedError
from exoid.leg.payload import Payload
from exoid.signals import FiniteDifference, Poses, Recording
from exoid.torques import Armature, Coulomb, LoadFriction, Motion, Offset, TorqueModel, Viscous
from exoid.torques.payloads import payload_torque

KT, ETA, RATIO = (0.07, 0.05), 0.85, 50.0
FRICTION = {"c0": 1.0, "d": 0.3, "offset": 0.0, "Ia": 0.6}
TERMS = (Coulomb(smoothing=0.01), Viscous(), Armature(), Offset())
PAYLOAD = (Payload("knee", 3.0, (0.0, 0.0, -0.3)),)
LEG = exoid.load_leg("cuhk")
TRUTH = dict(zip(LEG.parameter_names, LEG.parameters, strict=True)) | {"kt_hip": KT[0], "kt_knee": KT[1]}
TRUTH["J1"] += FRICTION["Ia"]


def torque_log(seed, payloads=(), seconds=20.0):
    """Motion with exact velocity, and true torque."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 0.005)
    f, phase, size = rng.uniform(0.15, 1.2, (5, 2)), rng.uniform(0.0, 6.3, (5, 2)), rng.uniform(0.1, 0.25, (5, 2))
    q, v, a = harmonics(t, size.T, 2.0 * np.pi * f.T, phase.T)
    model = TorqueModel(LEG, TERMS, separate=("Ia_hip",))
    values = [*LEG.parameters, *(FRICTION[name.partition("_")[0]] for name in model.names[len(LEG.parameters) :])]
    tau = model.regressor(q, v, a) @ values
    if payloads:
        tau = tau + payload_torque(LEG, payloads, Motion(q, v, a))
    return Recording(t, q, v, a, tau, joint_names=LEG.joint_names, payloads=payloads)


def log(seed, payloads=(), *, noise=0.02, eta=1.0, seconds=20.0, joints=(0, 1)):
    """Log of currents of some joints, and torques of the others."""
    true = torque_log(seed, payloads, seconds)
    current = true.tau / (RATIO * np.array(KT)) / np.where(true.tau * true.v > 0.0, eta, 1.0)
    current += noise * np.std(current, axis=0) * np.random.default_rng(seed).standard_normal(current.shape)
    driven = np.isin([0, 1], joints)
    tau = None if driven.all() else np.where(driven, np.nan, true.tau)
    return replace(true, v=None, a=None, tau=tau, current=np.where(driven, current, np.nan))


def motors(**changes):
    return {joint: Motor(None, **{"ratio": RATIO, **changes}) for joint in ("hip", "knee")}


def check_against(found, truth, within):
    for name, value in truth.items():
        if name not in ("Y1", "Y2"):
            assert found[name].value == pytest.approx(value, rel=within), name


def test_without_noise_constants_and_parameters_are_exact():
    """From starts that are wrong by a factor of two: what is left is the filters' error."""
    found = identify(LEG, [log(1, noise=0.0), log(2, PAYLOAD, noise=0.0)], TERMS, actuators=motors())
    check_against(found, TRUTH, 1e-3)
    assert found["kt_hip"].unit == "N·m/A"
    assert found["kt_hip"].interval[0] < KT[0] < found["kt_hip"].interval[1]
    true = (torque_log(1), torque_log(2, PAYLOAD))  # with their velocities only rounding is left, and rounds end, too
    logs = [replace(one, tau=None, current=one.tau / (RATIO * np.array(KT))) for one in true]
    found = identify(LEG, logs, TERMS, actuators=motors(), preparation=FiniteDifference())
    check_against(found, TRUTH, 1e-8)
    assert not found.warnings


def test_constants_of_joints_may_differ_by_orders_of_magnitude():
    """Efficiencies beside torque constants; one that runs to its bound on the way comes back."""
    factors = np.array([20.0, 0.1])
    logs = [log(1, eta=ETA, seconds=40.0), log(2, PAYLOAD, eta=ETA, seconds=40.0)]
    logs = [replace(one, current=one.current / factors) for one in logs]
    found = identify(LEG, logs, TERMS, actuators=motors(efficiency=None, back_efficiency=1.0))
    scaled = {"kt_hip": factors[0] * KT[0], "kt_knee": factors[1] * KT[1], "eta_hip": ETA, "eta_knee": ETA}
    check_against(found, TRUTH | scaled, 0.02)
    drive = found.actuators.drives["left_knee"]
    assert (drive.torque_constant, drive.efficiency) == (found["kt_knee"].value, found["eta_knee"].value)


def test_noise_of_the_current_attenuates_nothing():
    """As much noise as a third of the signal: a regression on the current itself would lose 8 % of the constant."""
    errors = [
        identify(LEG, [log(k, noise=0.3), log(100 + k, PAYLOAD, noise=0.3)], TERMS, actuators=motors())["kt_knee"].value
        for k in range(8)
    ]
    assert np.mean(errors) == pytest.approx(KT[1], rel=0.02)


def test_efficiency_alone_needs_no_payload():
    """With k_t known, what the joint drives back is known in N·m."""
    drives = {joint: Motor(kt, RATIO, None, back_efficiency=1.0) for joint, kt in zip(("hip", "knee"), KT, strict=True)}
    found = identify(LEG, log(1, eta=ETA, seconds=40.0), TERMS, actuators=drives)
    check_against(found, {"eta_hip": ETA, "eta_knee": ETA, "X2": TRUTH["X2"]}, 0.02)


def test_a_gear_that_loses_nothing_is_at_the_bound():
    """No efficiency is above 1: it is held there, and a warning says so."""
    found = identify(LEG, [log(31), log(32, PAYLOAD)], TERMS, actuators=motors(efficiency=None, back_efficiency=1.0))
    held = [name for name in ("eta_hip", "eta_knee") if found[name].value == 1.0]
    assert held
    assert all(found[name].identifiability == "held" for name in held)
    assert any("is at its upper bound, 1, and held there" in text for text in found.warnings)


def test_a_joint_with_a_torque_sensor_is_enough():
    """The hip's sensor knows the leg in N·m, and the knee's constant follows from the shared parameters."""
    found = identify(LEG, log(3, joints=(1,)), TERMS, actuators={"knee": Motor(None, RATIO)})
    check_against(found, {name: TRUTH[name] for name in ("X1", "J1", "X2", "J2", "kt_knee")}, 0.02)


def lifted(mass, noise):
    """Logs without a payload, and with one of little mass."""
    return [log(1, noise=noise), log(2, (replace(PAYLOAD[0], mass=mass),), noise=noise)]


BOTH = [log(1), log(2, PAYLOAD)]
REVERSED = [replace(one, current=-one.current) for one in BOTH]
Q = np.random.default_rng(5).uniform(-0.8, 0.8, (40, 2))
POSES = Poses(Q, LEG.gravity(Q), LEG.joint_names)
ENOUGH = {  # logs, options, and how exact constants and parameters are
    "a link that was weighed on a bench": (BOTH[:1], {"known": {"X2": TRUTH["X2"]}}, 0.03),
    "poses on a torque sensor": ([BOTH[0], POSES], {"terms": TERMS[:3]}, 0.03),
    "a payload, by ols": (BOTH, {"estimator": "ols"}, 0.02),
    "a payload, by huber": (BOTH, {"estimator": "huber"}, 0.02),
    "a payload, and currents of the other sign": (REVERSED, {"actuators": motors(ratio=-RATIO)}, 0.02),
}


@pytest.mark.parametrize("case", ENOUGH)
def test_what_is_known_in_newton_metres_is_enough(case):
    logs, options, within = ENOUGH[case]
    check_against(identify(LEG, logs, **{"terms": TERMS, "actuators": motors(), **options}), TRUTH, within)


REFUSED = {
    "nothing in N·m": (NotIdentifiableError, [log(1)], {}),
    "a known zero, which is zero in any unit": (NotIdentifiableError, [log(1)], {"known": {"c0_hip": 0.0}}),
    "a payload without weight": (NotIdentifiableError, lifted(0.0, 0.02), {}),
    "a payload that hardly weighs": (NotIdentifiableError, lifted(0.02, 0.2), {}),
    "a payload of grams": (NotIdentifiableError, lifted(0.002, 0.2), {}),
    "currents of the other sign": (NotIdentifiableError, REVERSED, {}),
    "torques that were measured": (NotIdentifiableError, [replace(BOTH[0], tau=torque_log(1).tau)], {}),
    "ml": (NotSupportedError, BOTH, {"estimator": "ml"}),
    "delays": (NotSupportedError, BOTH, {"delay": "auto"}),
    "load": (NotSupportedError, BOTH, {"terms": (LoadFriction(),)}),
    "groups": (NotSupportedError, BOTH, {"own": ("offset",)}),
}
"""Logs and options with which unknown constants are refused, with the kind of the error."""


@pytest.mark.parametrize("case", REFUSED)
def test_constants_that_nothing_determines_are_refused_by_name(case):
    kind, logs, options = REFUSED[case]
    with pytest.raises(kind) as error:
        identify(LEG, logs, actuators=motors(), **{"terms": TERMS, **options})
    assert "kt_hip" in str(error.value)
    assert error.value.remedy


@pytest.mark.parametrize("known", [None, {"c0_hip": 0.0}])
def test_a_check_finds_that_nothing_is_in_newton_metres(known):
    (finding,) = exoid.check(LEG, log(1), TERMS, actuators=motors(), known=known)
    assert (finding.kind, "weighed payload" in finding.remedy) == ("not-identifiable", True)


@pytest.mark.parametrize("constants", [KT, (None, None)])
def test_motors_that_are_warmer_in_the_log_of_the_payload_are_named(constants):
    """What is 5 % moved unknown constants by 11 % in silence, and looked like another payload beside known ones."""
    drives = {joint: Motor(kt, RATIO) for joint, kt in zip(("hip", "knee"), constants, strict=True)}
    hot = replace(BOTH[1], current=1.05 * BOTH[1].current)
    found = exoid.identify(LEG, [BOTH[0], hot], TERMS, actuators=drives)
    (one,) = found.findings
    assert (one.kind, one.joint, one.value) == ("change", "", pytest.approx(0.05, rel=0.1))
    assert constants[0] or (found["kt_hip"].identifiability, found["X2"].identifiability) == ("weakly", "weakly")


def test_a_wrong_value_is_named_beside_unknown_constants_that_took_it_in():
    """The log said 4.59 ± 0.015 kg·m, with the constants that the wrong value had made."""
    found = exoid.identify(LEG, BOTH, TERMS, actuators=motors(), known={"X1": 1.1 * TRUTH["X1"]})
    (one,) = found.findings
    assert (one.kind, one.value) == ("contradicted-value", pytest.approx(TRUTH["X1"], rel=0.01))


def test_of_two_values_that_set_an_unknown_constant_either_may_be_wrong():
    found = exoid.identify(LEG, BOTH[:1], TERMS, actuators=motors(), known={"X2": 1.1 * TRUTH["X2"], "J2": TRUTH["J2"]})
    (one,) = found.findings
    assert {"X2", "J2"} <= {*one.parameters}


def test_the_motor_whose_current_has_the_other_sign_is_named():
    """All constants of a leg turn on the way of the search where one has the wrong sign."""
    with pytest.raises(NotIdentifiableError) as caught:
        identify(LEG, [replace(one, current=one.current * [1.0, -1.0]) for one in BOTH], TERMS, actuators=motors())
    assert caught.value.parameters == ("kt_knee",)


def test_an_estimate_keeps_its_constants(tmp_path):
    """In its file, in validation of a log of currents, and in what it exports."""
    found = identify(LEG, [log(1), log(2, PAYLOAD)], TERMS, actuators=motors())
    again = from_file(found, tmp_path)
    assert again["kt_knee"] == found["kt_knee"]
    assert again.actuators.drives["left_knee"].torque_constant == found["kt_knee"].value
    assert exoid.validate(again, log(9)).verdict == "predicts"
    assert (exoid.validate(again, log(9, PAYLOAD)).nrmse < 0.01).all()
    assert "kt_knee" in str(found)
    assert re.search(r"from array, array with knee:3.0@0.0,0.0,-0.3 \(\d+ samples\); zero-phase", str(again))
    found.to_urdf(tmp_path / "leg.urdf")
    found.to_c(tmp_path / "leg.c")


def test_the_gain_of_a_force_channel_is_found_by_a_payload(tmp_path):
    """A load cell that reads 10 % too much, beside a motor whose constant is not known either."""
    points = Attachments(("thigh", (0.05, 0.0, -0.10)), ("shank", (0.05, 0.0, -0.06)))
    drives = Actuators.of(LEG, {"hip": Motor(KT[0], RATIO), "knee": LinearActuator(points)})
    logs = [drives.readings(torque_log(seed, payloads)) for seed, payloads in ((1, ()), (2, PAYLOAD))]
    wrong = [replace(one, v=None, a=None, force=1.1 * one.force) for one in logs]
    free = {"hip": Motor(None, RATIO), "knee": LinearActuator(points, gain=None)}
    found = identify(LEG, wrong, TERMS, actuators=free)
    check_against(found, {"kf_knee": 1.0 / 1.1, "kt_hip": KT[0], "X2": TRUTH["X2"]}, 0.01)
    found.to_c(tmp_path / "leg.c")
    assert f"/ ({found['kf_knee'].value!r} * " in (tmp_path / "leg.c").read_text()
    with pytest.raises(ExoidError, match=r"nothing is known in N·m, so that kt_hip, kf_knee"):
        identify(LEG, wrong[:1], TERMS, actuators=free)
    with pytest.raises(ExoidError, match="gain of the LinearActuator is not known"):
        Actuators.of(LEG, {"knee": free["knee"]}).torque(wrong[0])
    actuators = Actuators.of(LEG, free)
    assert actuators_from_data(actuators_to_data(actuators), LEG).drives["left_knee"].gain is None


@pytest.mark.parametrize("back", [None, 1.0, 0.7])
@pytest.mark.parametrize("symbol", ["kt", "eta"])
def test_the_sensitivity_is_the_derivative_of_the_torque(symbol, back):
    motor, v = Motor(0.07, RATIO, 0.8, back_efficiency=back), np.array([1.0, -1.0, 0.01, 0.0, -0.5])
    current = np.array([2.0, 2.0, -1.0, 3.0, -2.0])
    field, step = {"kt": "torque_constant", "eta": "efficiency"}[symbol], 1e-6
    value = getattr(motor, field)
    above, below = (replace(motor, **{field: value + sign * step}).torque(current, v, v) for sign in (1.0, -1.0))
    found = motor.sensitivity(symbol, motor.torque(current, v, v), v)
    np.testing.assert_allclose(found, (above - below) / (2.0 * step), rtol=1e-6, atol=1e-9)
