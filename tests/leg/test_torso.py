"""A moving torso: no further parameter, a changed gravity and an offset of the hip angle (doc. 1, end of II-B)."""

import numpy as np
import pinocchio as pin
import pytest
from planar_chains import PlanarURDF, assert_relative, random_chain, random_motion

from exoid import Leg, TorsoMotion

TOLERANCE = 1e-12


def random_torso(rng: np.random.Generator, samples: int) -> TorsoMotion:
    pitch, rate, acceleration = rng.uniform(-1, 1, (3, samples)) * np.array([[np.pi], [3.0], [10.0]])
    return TorsoMotion(pitch, rate, acceleration, rng.uniform(-8, 8, (samples, 2)))


def moved(leg: Leg, seed: int, samples: int = 50) -> tuple[np.ndarray, np.ndarray, np.ndarray, TorsoMotion]:
    rng = np.random.default_rng(seed)
    return (*random_motion(rng, len(leg.joint_names), samples), random_torso(rng, samples))


def chain_of(seed: int, axis: str) -> PlanarURDF:
    rng = np.random.default_rng(seed)
    return random_chain(rng, 1 + seed % 5, axis=axis, continuous=True)


@pytest.mark.parametrize("cumulative", [True, False])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_moving_torso_adds_no_parameter_to_any_planar_chain(axis, cumulative):
    for seed in range(25):
        leg = chain_of(seed, axis).leg(cumulative=cumulative)
        q, v, a, torso = moved(leg, seed, 10)
        torque = leg.inverse_dynamics(q, v, a, torso)
        assert_relative(leg.regressor(q, v, a, torso) @ leg.parameters, torque, TOLERANCE)


def test_pitch_is_an_offset_of_the_hip_angle(built_in_leg):
    q, v, a, torso = moved(built_in_leg, 2)
    pitching = TorsoMotion(torso.pitch, torso.pitch_rate, torso.pitch_acceleration)
    shifted = [x.copy() for x in (q, v, a)]
    entries = (torso.pitch, torso.pitch_rate, torso.pitch_acceleration)
    for x, entry in zip(shifted, entries, strict=True):
        x[:, 0] += entry  # the hip's axis is −lateral in both robots
    expected = built_in_leg.inverse_dynamics(*shifted)
    assert_relative(built_in_leg.inverse_dynamics(q, v, a, pitching), expected, TOLERANCE)
    # of the regressor too, but for a cumulative J, which multiplies the joints' own accelerations
    own = Leg.from_description(built_in_leg.description, built_in_leg.joint_names, cumulative=False)
    assert_relative(own.regressor(q, v, a, pitching), own.regressor(*shifted), TOLERANCE)


def test_hip_acceleration_is_a_changed_gravity(built_in_leg):
    """Accelerating up adds to gravity, accelerating forward makes it point backwards."""
    q, v, a, _ = moved(built_in_leg, 4)
    model = built_in_leg.model.copy()
    model.gravity.linear = -np.array([1.7, 0.0, 9.81 - 2.3])
    data = model.createData()
    expected = np.array([pin.rnea(model, data, *row) for row in zip(q, v, a, strict=True)])
    torso = TorsoMotion(hip_acceleration=(1.7, -2.3))
    assert_relative(built_in_leg.inverse_dynamics(q, v, a, torso), expected, TOLERANCE)
    assert_relative(built_in_leg.regressor(q, v, a, torso) @ built_in_leg.parameters, expected, TOLERANCE)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_pitching_torso_turns_the_leg_about_its_hip(axis):
    for seed in range(5):
        leg = chain_of(seed, axis).leg()
        q, _, _, torso = moved(leg, seed, 5)
        upright, tilted = leg.forward_kinematics(q), leg.forward_kinematics(q, torso)
        hip = upright.translation[:, :1]
        for i, pitch in enumerate(torso.pitch):
            R = pin.exp3(-leg.chain.plane.lateral * pitch)
            np.testing.assert_allclose(tilted.rotation[i], R @ upright.rotation[i], atol=TOLERANCE)
            turned = hip[i] + (upright.translation[i] - hip[i]) @ R.T
            np.testing.assert_allclose(tilted.translation[i], turned, atol=TOLERANCE)
