"""The leg: its dynamics against identities and other libraries, its names, limits and refusals."""

import re

import numpy as np
import pytest
from mujoco_torques import mujoco_model, mujoco_torque
from planar_chains import assert_relative, random_chain, random_motion
from small_urdfs import replaced

import exoid
from exoid import Leg, TorsoMotion
from exoid.errors import BadArgumentError
from exoid.experiments.excitation import MotionLimits
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.leg.description import describe
from exoid.leg.model import dynamic_parameters

STEP = 1e-6
"""Of finite differences [rad]."""


def legs() -> list[Leg]:
    """Both documents' legs and some random chains."""
    rng = np.random.default_rng(0)
    chains = [random_chain(rng, length, continuous=True).leg() for length in (1, 2, 3, 4, 5)]
    return [exoid.load_leg("bleex"), exoid.load_leg("cuhk", side="right"), *chains]


LEGS = pytest.mark.parametrize("leg", legs(), ids=lambda leg: f"{leg.description.name}-{len(leg.joint_names)}")


def motion_of(leg: Leg, samples: int = 20, seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return random_motion(np.random.default_rng(seed), len(leg.joint_names), samples)


@LEGS
def test_the_mass_matrix_is_symmetric_and_positive_definite(leg):
    M = leg.mass_matrix(motion_of(leg)[0])
    np.testing.assert_array_equal(M, np.swapaxes(M, 1, 2))
    assert (np.linalg.eigvalsh(M)[:, 0] > 0).all()


@LEGS
def test_joint_power_is_the_rate_of_the_whole_energy(leg):
    """τ·v = d/dt (½ vᵀ M v) + G·v along an accelerated motion."""
    q, v, a = motion_of(leg)

    def kinetic(angles: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        return 0.5 * np.einsum("ni,nij,nj->n", velocities, leg.mass_matrix(angles), velocities)

    before, after = (kinetic(q + s * STEP * v, v + s * STEP * a) for s in (-1, 1))
    power = np.einsum("ni,ni->n", leg.inverse_dynamics(q, v, a), v)
    assert_relative((after - before) / (2 * STEP) + np.einsum("ni,ni->n", leg.gravity(q), v), power, 1e-7)


@pytest.mark.parametrize(("name", "inertias"), list(URDFS))
def test_mujoco_has_the_same_inverse_dynamics(name, inertias, side):
    """MuJoCo's own reading of the URDF and its own algorithm.

    Its inverse dynamics would add what exoid keeps apart as terms or does not model: the <dynamics> of the URDF
    (damping, friction loss) and the forces of joint limits and contacts. All are switched off.
    """
    leg = exoid.load_leg(name, side=side, inertias=inertias)
    model = mujoco_model(urdf_folder() / URDFS[name, inertias])
    model.dof_damping[:] = 0.0
    model.dof_frictionloss[:] = 0.0
    rng = np.random.default_rng(2)
    q = rng.uniform(leg.limits.lower, leg.limits.upper, (50, len(leg.joint_names)))
    v, a = rng.uniform(-1, 1, (2, *q.shape)) * np.array([5.0, 20.0])[:, None, None]
    torque = mujoco_torque(model, leg.joint_names, q, v, a)
    np.testing.assert_allclose(torque, leg.inverse_dynamics(q, v, a), rtol=0, atol=1e-9)
    np.testing.assert_allclose(torque, leg.regressor(q, v, a) @ leg.parameters, rtol=0, atol=1e-9)


@pytest.mark.parametrize("continuous", [False, True])
def test_locking_a_joint_is_holding_it_still_at_that_angle(continuous):
    rng = np.random.default_rng(4)
    for _ in range(10):
        chain = random_chain(rng, 4, continuous=continuous)
        full, angles = chain.leg(), rng.uniform(-3, 3, 2)
        moving, held = ("hip", "toe"), ("knee", "ankle")
        locked = Leg.from_description(full.description, moving, locked=dict(zip(held, angles, strict=True)))
        assert locked.joint_names == moving
        q, v, a = random_motion(rng, 2)
        whole = [np.zeros((len(q), 4)) for _ in range(3)]
        for target, x in zip(whole, (q, v, a), strict=True):
            target[:, [0, 3]] = x
        whole[0][:, [1, 2]] = angles
        expected = full.inverse_dynamics(*whole)[:, [0, 3]]
        assert_relative(locked.inverse_dynamics(q, v, a), expected, 1e-12)
        assert_relative(locked.regressor(q, v, a) @ locked.parameters, expected, 1e-12)


def test_joints_that_are_neither_moving_nor_locked_are_held_at_zero(leg):
    thigh_and_shank = Leg.from_description(leg.description, ("left_hip", "left_knee"))
    q, v, a = random_motion(np.random.default_rng(5), 2)
    expected = leg.inverse_dynamics(*(np.hstack([x, np.zeros((len(x), 1))]) for x in (q, v, a)))[:, :2]
    assert_relative(thigh_and_shank.inverse_dynamics(q, v, a), expected, 1e-12)


def test_continuous_joints_compute_like_revolute_ones_and_have_no_limits():
    rng = np.random.default_rng(7)
    chain = random_chain(rng, 3)
    turning = Leg.from_description(describe(chain.text.replace('"revolute"', '"continuous"')))
    revolute = chain.leg()
    assert turning.model.nq == 6
    motion = random_motion(rng, 3)
    assert_relative(turning.inverse_dynamics(*motion), revolute.inverse_dynamics(*motion), 1e-12)
    assert_relative(turning.regressor(*motion), revolute.regressor(*motion), 1e-13)
    np.testing.assert_array_equal(turning.limits.lower, [-np.inf] * 3)
    np.testing.assert_array_equal(turning.limits.upper, [np.inf] * 3)
    np.testing.assert_array_equal(revolute.limits.upper, [3.0] * 3)


@pytest.mark.parametrize(("limit", "kept"), [("6.2832", True), ("90", False)])
def test_limits_in_degrees_are_named_before_a_plan_is_made(limit, kept):
    text = replaced('lower="-2" upper="0"', f'lower="-{limit}" upper="{limit}"')
    leg = Leg.from_description(describe(text), ("hip", "knee"))
    if kept:
        assert MotionLimits.of(leg, margin=0.0).upper[1] == float(limit)
        return
    with pytest.raises(BadArgumentError, match="no limits in rad or m of joint 'knee', but -90 to 90") as refused:
        MotionLimits.of(leg)
    assert "--angles knee=LOW:HIGH" in refused.value.for_command()


def test_zeros_of_a_cad_exporter_are_no_limits(tmp_path):
    """The exporter of SolidWorks writes lower="0" upper="0" effort="0" velocity="0" for limits that nobody gave."""
    text = (urdf_folder() / URDFS["bleex", "cad"]).read_text(encoding="utf-8")
    given = re.search(r'<joint name="left_knee".*?(<limit[^>]*>)', text, flags=re.DOTALL).group(1)
    path = tmp_path / "exported.urdf"
    path.write_text(text.replace(given, '<limit lower="0" upper="0" effort="0" velocity="0"/>'), encoding="utf-8")
    leg = exoid.Leg.from_urdf(path, joints=("left_hip", "left_knee", "left_ankle"))
    assert [limit[1] for limit in leg.limits] == [-np.inf, np.inf, np.inf, np.inf]
    assert np.isfinite([limit[[0, 2]] for limit in leg.limits]).all()
    with pytest.raises(BadArgumentError) as refused:
        MotionLimits.of(leg)
    assert refused.value.joints == ("left_knee",)
    assert MotionLimits.of(leg, margin=0.0, angles_deg={"left_knee": (-90.0, -5.0)}).upper[1] == np.deg2rad(-5.0)


@pytest.mark.parametrize(
    "names", [("left_hip", "right_knee"), ("left_hip", "knee"), ("hip", "knee"), ("left_", "left_knee")]
)
def test_labels_are_the_names_where_the_side_is_not_the_same_for_all(names):
    text = random_chain(np.random.default_rng(9), 2).text
    for old, new in zip(("hip", "knee"), names, strict=True):
        text = text.replace(f'<joint name="{old}"', f'<joint name="{new}"')
    assert Leg.from_description(describe(text)).joint_labels == names


def test_a_leg_with_other_parameters_has_their_torques(built_in_leg):
    rng = np.random.default_rng(10)
    new = built_in_leg.parameters * rng.uniform(0.7, 1.3, len(built_in_leg.parameters))
    before = dynamic_parameters(built_in_leg.model)
    changed = built_in_leg.with_parameters(new)
    np.testing.assert_array_equal(dynamic_parameters(built_in_leg.model), before)
    np.testing.assert_allclose(dynamic_parameters(changed.model)[::10], before[::10], rtol=1e-15)
    motion = motion_of(built_in_leg)
    np.testing.assert_allclose(changed.parameters, new, rtol=1e-13)
    assert_relative(changed.inverse_dynamics(*motion), built_in_leg.regressor(*motion) @ new, 1e-12)
    assert_relative(changed.regressor(*motion), built_in_leg.regressor(*motion), 1e-15)
    torso = TorsoMotion(0.3, 0.2, 0.1, (0.5, -0.5))
    assert_relative(changed.inverse_dynamics(*motion, torso), built_in_leg.regressor(*motion, torso) @ new, 1e-12)
