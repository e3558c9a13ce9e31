"""Payloads and wrenches that a log states wrongly: masses, places, signs and units."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from logs import clean, kinds, of_kind
from swings import Swing, with_payloads

import exoid
from exoid.signals import Wrench

PLACE = (0.0, 0.0, -0.3)


@pytest.mark.parametrize("stated", [1.7, 2.0, 4.4])
def test_a_mass_of_a_payload_in_one_of_two_logs(stated):
    leg, log = clean("cuhk")
    joint = leg.joint_names[1]
    loaded = Swing(with_payloads(leg, [exoid.Payload(joint, 2.0, PLACE)]), seconds=30.0, seed=2, smoothing=0.015)
    heavy = loaded.recording(v=None, a=None, payloads=(exoid.Payload(joint, stated, PLACE),))
    found = exoid.check(leg, [log, heavy])
    if stated == 2.0:
        assert not kinds(found)
    else:
        assert of_kind(found, "known-torque").value == pytest.approx(2.0 / stated, rel=0.05)


def test_a_payload_in_the_only_log_that_is_far_too_heavy_is_no_wrong_sign():
    leg, _ = clean("cuhk")
    joint = leg.joint_names[1]
    log = Swing(with_payloads(leg, [exoid.Payload(joint, 2.0, PLACE)]), seconds=30.0, seed=2, smoothing=0.015)
    found = exoid.check(leg, log.recording(v=None, a=None, payloads=(exoid.Payload(joint, 20.0, PLACE),)))
    assert "payload" in of_kind(found, "impossible-leg").remedy
    assert not kinds(found) & {"torque-sign", "angle-sign"}


@pytest.mark.parametrize(
    ("name", "how"), [("X2", lambda x: 0.97 * x), ("J3", lambda x: (2.0 * x, 0.01 * x)), ("J2", lambda x: 9.0 * x)]
)
def test_a_value_that_the_log_contradicts(name, how):
    """A wrong mass moment gave a wrong inertia in silence, and a wrong prior won over the log."""
    leg, log = clean()
    right = float(leg.parameters[leg.parameter_names.index(name)])
    (one,) = exoid.identify(leg, log, **{"prior" if name == "J3" else "known": {name: how(right)}}).findings
    assert (one.kind, one.severity) == ("contradicted-value", "warning")
    assert {name, "J1"} <= {*one.parameters}  # which moved, too
    assert abs(one.value - right) < np.ptp(one.interval) < 0.1 * right  # the told value adds nothing to the noise


@pytest.fixture(scope="module")
def held():
    """CUHK-EXO's leg and a log in which its shank is held by a load cell: the force, and the log without it."""
    leg, log = clean("cuhk")
    rng, t = np.random.default_rng(3), log.time
    sizes, rates, phases = rng.normal(0.0, 8.0, (4, 3)), rng.uniform(0.1, 0.8, (4, 3)), rng.uniform(0.0, 6.0, (4, 3))
    force = (sizes * np.sin(2.0 * np.pi * rates * t[:, None, None] + phases)).sum(axis=1)
    data, frame = leg.model.createData(), leg.model.getFrameId(leg.link_names[1])
    point, tau = np.array(PLACE), np.array(log.tau)
    for k, q in enumerate(log.q):
        J = pin.computeFrameJacobian(leg.model, data, q, frame, pin.ReferenceFrame.LOCAL)
        tau[k] -= J.T @ np.concatenate([force[k], np.cross(point, force[k])])
    return leg, dataclasses.replace(log, tau=tau), force


@pytest.mark.parametrize("factor", [1.0, -1.0, 1.0 / 9.81, 1.1])
def test_the_sign_and_the_unit_of_a_force_sensor(held, factor):
    leg, log, force = held
    wrench = Wrench(factor * force, np.zeros_like(force), point=PLACE)
    found = exoid.check(leg, dataclasses.replace(log, wrenches={leg.link_names[1]: wrench}))
    if factor == 1.0:
        assert not kinds(found)
    else:
        of_wrench = of_kind(found, "known-torque")
        assert of_wrench.value == pytest.approx(1.0 / factor, rel=0.03)
        assert ("wrong sign" in of_wrench.message) == (factor < 0.0)


def test_a_force_sensor_that_is_late(held):
    leg, log, force = held
    late = np.column_stack([np.interp(log.time - 0.02, log.time, part) for part in force.T])
    wrench = Wrench(late, np.zeros_like(late), point=PLACE)
    found = exoid.check(leg, dataclasses.replace(log, wrenches={leg.link_names[1]: wrench}))
    assert kinds(found) == {"wrench-delay"}
    assert of_kind(found, "wrench-delay").value == pytest.approx(0.02, abs=0.001)
