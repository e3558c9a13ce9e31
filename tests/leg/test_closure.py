"""Closed loops: Pinocchio's constrained dynamics and finite differences are the truth."""

import tempfile
from functools import cache, partial
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from closed_machines import cylinder_knee, four_bar_knee, to_mjcf, two_rod_ankle, welded_knee
from outcomes import refused

from exoid import Leg, torques
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError, UnreadableInputError
from exoid.experiments.limits import MotionLimits
from exoid.lab.study import LegText
from exoid.leg.base_kinematics import BaseKinematics

MACHINES = {"knee": four_bar_knee, "cylinder": cylinder_knee, "weld": welded_knee, "ankle": two_rod_ankle}
MACHINES["short cylinder"] = partial(cylinder_knee, horn=0.5, limit=0.2)  # which reaches 35 mm


@cache
def built(name: str, seed: int) -> Leg:
    """Machine of one kind, drawn by seed; its base parameters take a second."""
    with tempfile.TemporaryDirectory() as folder:
        return MACHINES[name](seed).leg(Path(folder))


@pytest.fixture(params=[(name, seed) for name in MACHINES for seed in (0, 1)], ids=str)
def leg(request: pytest.FixtureRequest) -> Leg:
    return built(*request.param)


def random_motion(leg: Leg, samples: int = 40, seed: int = 5):
    rng, size = np.random.default_rng(seed), leg.closure.sizes
    v, a = size * rng.normal(0.0, 2.0, (2, samples, len(leg.joint_names)))
    return leg.closure.reachable(size * rng.uniform(-0.5, 0.5, v.shape)), v, a


def constraints(leg: Leg) -> pin.StdVec_RigidConstraintModel:
    """The points of all loops as Pinocchio's constraints."""
    found = pin.StdVec_RigidConstraintModel()
    kind, axes = pin.ContactType.CONTACT_3D, pin.ReferenceFrame.LOCAL
    for pair in leg.closure.pairs:
        ends = [(body + 1, pin.SE3(np.eye(3), place)) for body, place in zip(pair.bodies, pair.places, strict=True)]
        found.append(pin.RigidConstraintModel(kind, leg.model, *ends[0], *ends[1], axes))
    return found


def test_torques_give_the_acceleration_of_constrained_dynamics(leg):
    q, v, a = random_motion(leg)
    tree, torque = leg.tree_motion(q, v, a), leg.inverse_dynamics(q, v, a)
    models = constraints(leg)
    data, datas = leg.model.createData(), pin.StdVec_RigidConstraintData()
    datas.extend(model.createData() for model in models)
    pin.initConstraintDynamics(leg.model, data, models, datas)
    settings = pin.ProximalSettings(1e-14, 1e-10, 200)
    driven = leg.closure.independent
    for k in range(len(q)):
        tau = np.zeros(leg.model.nv)
        tau[driven] = torque[k]
        found = pin.constraintDynamics(leg.model, data, tree.q[k], tree.v[k], tau, models, datas, settings)
        np.testing.assert_allclose(found, tree.a[k], rtol=1e-9, atol=1e-9 * np.abs(tree.a[k]).max())


def test_loops_close_and_the_regressor_gives_the_torque(leg):
    q, v, a = random_motion(leg, 300)
    tree = leg.tree_motion(q, v, a)
    assert leg.closure.gap(tree.q).max() < 1e-12
    np.testing.assert_array_equal(tree.q[:, leg.closure.independent], q)
    opened, data, apart = tree.q[0] + 0.02 * np.arange(tree.q.shape[1]), leg.model.createData(), {}
    pin.forwardKinematics(leg.model, data, opened)
    for pair in leg.closure.pairs:
        first, second = (data.oMi[body + 1] * place for body, place in zip(pair.bodies, pair.places, strict=True))
        apart.setdefault(pair.loop.name, []).append(np.linalg.norm(first - second))
    np.testing.assert_allclose(leg.closure.gap(opened[None])[0], [max(each) for each in apart.values()], rtol=1e-9)
    torque = leg.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(leg.regressor(q, v, a) @ leg.parameters, torque, atol=1e-12 * np.abs(torque).max())


def test_random_motion_closes_all_loops_with_bounded_velocities(leg):
    """Dependent joints turn at most 7 times as fast as at the reference, and the poses fill the reach."""
    q, v, a = torques.motion.random_motion(300, len(leg.joint_names), leg.closure)
    home = leg.closure.rates(np.tile(leg.closure.reference, (300, 1)), v, a)
    most, usual = (np.abs(each.G).max(axis=(0, 2)) for each in (leg.tree_motion(q, v, a), home))
    assert (most < 7.0 * usual).all()
    assert (q.std(axis=0) > 0.3 * leg.closure.sizes).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3, *(pytest.param(k, marks=pytest.mark.nightly) for k in (1, 2))])
def test_limits_beyond_the_reach_take_no_base_parameter_away(seed, tmp_path):
    legs = [cylinder_knee(seed, 0.6, limit).leg(tmp_path) for limit in (0.03, 0.045, 0.08, 0.2, 100.0)]
    assert [len(leg.parameter_names) for leg in legs] == 5 * [8]


@pytest.mark.parametrize("make", [four_bar_knee, two_rod_ankle])
def test_motion_within_the_limits_of_a_plan_closes(make, tmp_path):
    machine = make(0)
    leg = machine._replace(urdf=machine.urdf.replace('"0.6"', '"1.9"').replace('"-0.6"', '"-1.9"')).leg(tmp_path)
    limits = MotionLimits.of(leg, margin=0.0)
    q = np.random.default_rng(1).uniform(limits.lower, limits.upper, (4000, len(leg.joint_names)))
    assert leg.closure.solve(q)[1].all()
    assert not leg.closure.solve(1.9 * np.sign(q))[1].all()
    assert (limits.span > 1.6).all()


def test_velocity_and_acceleration_are_derivatives_of_the_pose(leg):
    q, v, a = random_motion(leg)
    h = 1e-4
    poses = [leg.tree_motion(q + s * h * v + 0.5 * (s * h) ** 2 * a).q for s in (-1, 0, 1)]
    tree = leg.tree_motion(q, v, a)
    np.testing.assert_allclose((poses[2] - poses[0]) / (2 * h), tree.v, atol=2e-5 * np.abs(tree.v).max())
    np.testing.assert_allclose((poses[2] - 2 * poses[1] + poses[0]) / h**2, tree.a, atol=1e-3 * np.abs(tree.a).max())


def test_mass_matrix_gravity_and_jacobian_are_those_of_the_torque(leg):
    q, v, _ = random_motion(leg)
    still = np.zeros_like(q)
    M, G = leg.mass_matrix(q), leg.gravity(q)
    np.testing.assert_allclose(leg.inverse_dynamics(q, still, still), G, atol=1e-12)
    for k, one in enumerate(np.eye(len(leg.joint_names))):
        column = leg.inverse_dynamics(q, still, still + one) - G
        np.testing.assert_allclose(M[..., k], column, atol=1e-12 * np.abs(column).max())
    link, h = leg.bodies[-1], 1e-6
    body = list(leg.bodies).index(link)
    ends = [leg.forward_kinematics(q + s * h * v).translation[:, body] for s in (-1, 1)]
    turn = leg.forward_kinematics(q).rotation[:, body]
    twist = np.einsum("bij,bj->bi", leg.frame_jacobian(q, link), v)
    velocity = np.einsum("bij,bj->bi", turn, twist[:, :3])
    np.testing.assert_allclose((ends[1] - ends[0]) / (2 * h), velocity, atol=1e-7)


WRONG = {
    "a rod too short to close": ('"rear", xyz = [', '"rear", xyz = [0.5, 0, 0], rpy = [', BadArgumentError),
    "an unknown link": ('"rear"', '"raer"', BadArgumentError),
    "an unknown joint": ('"rear_pin"', '"rear_pim"', BadArgumentError),
    "a joint in no loop": ('"rear_pin"', '"hip"', BadArgumentError),
    "too few dependent joints": (', "rear_pin"', "", BadArgumentError),
    "an unknown kind": ('"pin"', '"glue"', UnreadableInputError),
    "an unknown key": ("axis", "axes", UnreadableInputError),
    "no loop": ("[[loops]]", "[loops]", UnreadableInputError),
    "two frames of one link": ('"rear", xyz', '"shank", xyz', BadArgumentError),
    "no TOML": ("dependent = [", "dependent = ", UnreadableInputError),
}


@pytest.mark.parametrize("kind", WRONG)
def test_wrong_loops_are_refused_in_one_line(kind, tmp_path):
    machine, (old, new, error) = four_bar_knee(0), WRONG[kind]
    assert old in machine.loops
    refused(error, lambda: machine.leg(tmp_path, machine.loops.replace(old, new)))


@pytest.mark.parametrize(
    ("make", "sites"),
    [
        (four_bar_knee, True),
        pytest.param(two_rod_ankle, True, marks=pytest.mark.slow),
        pytest.param(four_bar_knee, False, marks=pytest.mark.slow),
        (welded_knee, True),
    ],
)
def test_mjcf_describes_the_same_loops(make, sites, tmp_path):
    machine = make(0)
    leg, spec = machine.leg(tmp_path), to_mjcf(machine, sites=sites)
    spec.compile()
    (tmp_path / "leg.xml").write_text(spec.to_xml())
    other = Leg.from_urdf(tmp_path / "leg.urdf", loops=tmp_path / "leg.xml")
    assert other.joint_names == leg.joint_names
    q, v, a = random_motion(leg)
    torque = leg.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(other.inverse_dynamics(q, v, a), torque, atol=2e-5 * np.abs(torque).max())


def test_what_exoid_cannot_read_in_an_mjcf_is_refused(tmp_path):
    machine = four_bar_knee(0)
    machine.leg(tmp_path)
    spec = to_mjcf(machine)
    spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT, name1="front_pin", name2="rear_pin", objtype=mujoco.mjtObj.mjOBJ_JOINT
    )
    spec.compile()
    latin = to_mjcf(machine).to_xml().replace("shank", "jambe_pliée")
    texts = ((spec.to_xml(), NotSupportedError), ("<mujoco", UnreadableInputError), (latin, UnreadableInputError))
    for text, error in texts:
        (tmp_path / "leg.xml").write_text(text, encoding="latin-1")
        with pytest.raises(error, match=r"leg\.xml"):
            Leg.from_urdf(tmp_path / "leg.urdf", loops=tmp_path / "leg.xml")


def test_motion_beyond_a_dead_centre_is_refused_with_its_sample(tmp_path):
    q = np.zeros((30, 2))
    q[17] = [0.1, 2.9]
    with pytest.raises(BadArgumentError, match=r"sample 17, loop four-bar .* at hip = 0.1, knee = 2.9"):
        four_bar_knee(0).leg(tmp_path).gravity(q)


def test_what_closed_loops_do_not_have_is_refused(tmp_path):
    machine = four_bar_knee(0)
    with pytest.raises(NotSupportedError, match="floating base"):
        machine.leg(tmp_path, base="floating")
    with pytest.raises(ExoidError, match="dependent joints of loops"):
        machine.leg(tmp_path, joints=("hip", "knee", "front_pin"))
    with pytest.raises(NotSupportedError, match="studies simulate trees"):  # whose plan alone takes minutes
        LegText.of(machine.leg(tmp_path))


def test_a_moving_base_gives_the_torque_that_its_motion_causes(tmp_path):
    """Accelerating the base upwards at 9.81 m/s² doubles gravity."""
    leg = four_bar_knee(0).leg(tmp_path, base="moving")
    q, v, a = random_motion(leg)
    still = np.zeros((len(q), 3))
    base = BaseKinematics(still, still, np.tile([0.0, 0.0, 2 * 9.81], (len(q), 1)))
    torque = leg.inverse_dynamics(q, v, a, base)
    np.testing.assert_allclose(torque, leg.inverse_dynamics(q, v, a) + leg.gravity(q), atol=1e-9)
    np.testing.assert_allclose(leg.regressor(q, v, a, base) @ leg.parameters, torque, atol=1e-9)
