"""A measured force on a link is known in N: with it torque constants, efficiencies and loads of gears are found."""

from dataclasses import replace

import numpy as np
import pytest
from swings import harmonics
from unchecked import identify

import exoid
from exoid import Recording
from exoid.actuators import Motor
from exoid.signals import Wrench
from exoid.torques import LoadFriction, TorqueModel

LEG = exoid.load_leg("cuhk")
CONSTANTS = {"left_hip": 0.08, "left_knee": 0.05}
RATIO = 50.0
PLACE = (0.0, 0.0, -0.3)
UNKNOWN = {joint: Motor(torque_constant=None, ratio=RATIO) for joint in CONSTANTS}
FRICTION = np.array([0.8, 0.4])  # N·m·s/rad
NOISE = 0.01  # A
TERMS = (exoid.Viscous(),)


def motion(seconds=25.0):
    """Sines of both joints, logged at 200 Hz."""
    t = np.arange(0.0, seconds, 0.005)
    rates = 2.0 * np.pi * np.array([0.2, 0.5, 0.9, 1.3])
    q, v, a = harmonics(t, 0.25 / np.arange(1.0, 5.0), rates, np.arange(8.0).reshape(4, 2).T)
    return t, q + np.array([0.2, -0.6]), v, a


def pulled(seed, more=None, force=20.0):
    """Currents of a leg that a force of some newtons pulls at the shank, along the x axis of the link."""
    t, q, v, a = motion()
    f = np.zeros((len(t), 3))
    f[:, 0] = force * (np.sin(4.4 * t) + 0.5 * np.sin(11.0 * t + 1.0))
    wrench = Wrench(f, np.zeros_like(f), point=PLACE)
    jacobian = LEG.frame_jacobian(q, "left_shank", PLACE)  # (N, 6, n)
    load = LEG.inverse_dynamics(q, v, a) - np.einsum("ncr,nc->nr", jacobian[:, :3], f)
    tau = load + FRICTION * v + (0.0 if more is None else more(load, v))
    noise = np.random.default_rng(seed).normal(0.0, NOISE, tau.shape)
    current = tau / (RATIO * np.array(list(CONSTANTS.values()))) + noise
    return Recording(time=t, q=q, current=current, joint_names=LEG.joint_names, wrenches={"left_shank": wrench})


def test_a_force_sensor_gives_torque_constants_with_honest_intervals():
    inside = []
    for seed in range(1000, 1012):
        estimate = identify(LEG, pulled(seed), TERMS, actuators=UNKNOWN)
        for joint, constant in CONSTANTS.items():
            one = estimate[f"kt_{joint.removeprefix('left_')}"]
            assert one.value == pytest.approx(constant, rel=1e-3)
            inside.append(one.interval[0] <= constant <= one.interval[1])
        np.testing.assert_allclose(estimate.values[:6], LEG.parameters, atol=0.01)
    assert np.mean(inside) >= 0.8


@pytest.mark.parametrize("force", [0.0, None])
def test_without_a_force_nothing_is_known_in_newton_metres(force):
    log = pulled(1, force=0.0)
    log = replace(log, wrenches={}) if force is None else log
    with pytest.raises(exoid.ExoidError, match="nothing is known in N·m") as error:
        exoid.identify(LEG, log, TERMS, actuators=UNKNOWN)
    assert "wrenches=" in error.value.remedy


def test_friction_that_grows_with_the_load_counts_the_force_as_load():
    mu = 0.1

    def gear(load, v):
        return mu * np.abs(load) * np.tanh(v / 0.05)

    log = pulled(3, more=gear, force=60.0)
    tau = log.current * RATIO * np.array(list(CONSTANTS.values()))
    log = replace(log, current=None, tau=tau)
    term = LoadFriction(smoothing=0.05)
    names = TorqueModel(LEG, (*TERMS, term)).names
    estimate = exoid.identify(LEG, log, (*TERMS, term))
    for joint in ("hip", "knee"):
        (name,) = (each for each in names if each.startswith("mu") and each.endswith(joint))
        assert estimate[name].value == pytest.approx(mu, rel=0.05)


def test_a_leg_that_is_moved_by_a_hand_is_known_by_the_force_of_the_hand():
    t, q, v, a = motion()
    jacobian = LEG.frame_jacobian(q, "left_shank", PLACE)
    needed = np.linalg.solve(  # a force and a moment of the hand that drive both joints
        jacobian[:, [0, 4]].transpose(0, 2, 1), LEG.inverse_dynamics(q, v, a)[..., None]
    )[..., 0]
    zeros = np.zeros_like(t)
    wrench = Wrench(
        np.column_stack([needed[:, 0], zeros, zeros]), np.column_stack([zeros, needed[:, 1], zeros]), point=PLACE
    )
    names = LEG.joint_names
    log = Recording(
        time=t, q=q, tau=np.zeros_like(q), joint_names=names, wrenches={"left_shank": wrench}, passive=names
    )
    estimate = exoid.identify(LEG, log, ())
    np.testing.assert_allclose(estimate.values, LEG.parameters, rtol=2e-3, atol=2e-3)
    with pytest.raises(exoid.ExoidError, match="only ratios"):
        exoid.identify(LEG, replace(log, wrenches={}), ())
