"""A base that moves in space: joint torques need ω, ω̇ and f only, and no further parameter in the plane of the leg."""

import numpy as np
import pytest
from free_flyers import Flight
from planar_chains import assert_relative, random_chain, random_motion
from public_robots import urdf_of

import exoid
from exoid import ExoidError, Leg, TorsoMotion
from exoid.identification.findings.base_motion import out_of_plane_torque
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.torso import base_kinematics

TOLERANCE = 1e-12


def flown(leg, seed):
    """Joints, motion of the base, and joint torques of Pinocchio's free-flyer with random pose and velocity."""
    flight = Flight.random(leg, np.random.default_rng(seed), 40)
    return flight.joints, flight.base, flight.rows()[:, 6:]


def test_position_heading_and_velocity_of_the_base_have_no_effect(leg):
    motion, base, torques = flown(leg, 1)
    assert_relative(leg.inverse_dynamics(*motion, base), torques, TOLERANCE)


def planar_legs():
    chains = (random_chain(np.random.default_rng(k), 1 + k % 5, axis="xy"[k % 2], continuous=True) for k in range(10))
    return [exoid.load_leg("bleex"), exoid.load_leg("cuhk"), *(chain.leg() for chain in chains)]


@pytest.mark.parametrize("seed", range(8))
def test_a_planar_leg_needs_no_further_parameter_for_motion_within_its_plane(seed):
    leg = random_chain(np.random.default_rng(seed), 1 + seed % 4, axis="yx"[seed % 2]).leg()
    motion, base, _ = flown(leg, seed)
    plane = base.within_plane(leg.chain.plane, leg.hip)
    assert_relative(leg.regressor(*motion, plane) @ leg.parameters, leg.inverse_dynamics(*motion, plane), TOLERANCE)
    assert_relative(leg.regressor(*motion, base), leg.regressor(*motion, plane), TOLERANCE)


@pytest.mark.parametrize("leg", planar_legs())
def test_the_torso_s_motion_is_a_case_of_the_base_s(leg):
    rng = np.random.default_rng(3)
    motion = random_motion(rng, len(leg.joint_names), 30)
    torso = TorsoMotion(*rng.normal(size=(3, 30)), 5.0 * rng.normal(size=(30, 2)))
    base = base_kinematics(torso, 30, leg.chain.plane, leg.hip)
    assert_relative(leg.inverse_dynamics(*motion, base), leg.inverse_dynamics(*motion, torso), TOLERANCE)
    assert_relative(leg.regressor(*motion, base), leg.regressor(*motion, torso), TOLERANCE)


def legs_in_space():
    for name in ("bleex", "cuhk"):
        yield Leg.from_description(exoid.load_leg(name).description, exoid.load_leg(name).joint_names, base="moving")
    yield Leg.from_urdf(urdf_of("ur5"), base="moving")
    yield Leg.from_description(random_chain(np.random.default_rng(5), 3, axis="y").description, base="moving")


@pytest.mark.parametrize("leg", list(legs_in_space()), ids=lambda leg: leg.description.name)
def test_a_leg_made_for_it_describes_every_motion_of_its_base(leg):
    motion, base, torques = flown(leg, 2)
    assert_relative(leg.regressor(*motion, base) @ leg.parameters, torques, TOLERANCE)
    assert_relative(leg.regressor(*motion) @ leg.parameters, leg.inverse_dynamics(*motion), TOLERANCE)


def test_a_spatial_leg_of_a_fixed_base_refuses_a_moving_one():
    leg = Leg.from_urdf(urdf_of("ur5"))
    motion = random_motion(np.random.default_rng(0), 6, 5)
    base = BaseKinematics(*np.zeros((2, 5, 3)), np.tile([0.0, 0.0, 9.81], (5, 1)))
    with pytest.raises(ExoidError, match="moving base") as error:
        leg.regressor(*motion, base)
    assert 'base="moving"' in error.value.remedy


def test_the_torque_out_of_the_plane_is_that_of_pinocchio_and_nothing_moves_it_sideways():
    leg, rng = exoid.load_leg("bleex"), np.random.default_rng(4)
    motion, base, torques = flown(leg, 4)
    extra, whole = out_of_plane_torque(leg, *motion, base)
    assert_relative(whole, torques, TOLERANCE)
    assert_relative(leg.regressor(*motion, base) @ leg.parameters, torques - extra, TOLERANCE)
    sideways = BaseKinematics(np.zeros((40, 3)), np.zeros((40, 3)), rng.normal(size=(40, 3)) * [5.0, 8.0, 5.0])
    assert np.abs(out_of_plane_torque(leg, *motion, sideways)[0]).max() < 1e-12
    turning = BaseKinematics(rng.normal(size=(40, 3)) * [1.0, 0.0, 1.0], np.zeros((40, 3)), base.specific_force)
    products = np.abs(turning.angular_velocity[:, [0]] * turning.angular_velocity[:, [2]]) + np.sum(
        turning.angular_velocity**2, axis=1, keepdims=True
    )
    bound = products * leg.parameters[2]  # J of the whole leg
    assert (np.abs(out_of_plane_torque(leg, *motion, turning)[0]) <= bound + 1e-12).all()
