"""An exported URDF is the user's own with other numbers, and every library that reads it finds the estimate."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from lxml import etree
from made_estimates import made, motion_within
from public_robots import urdf_of

import exoid
from exoid import Coulomb, Leg, Viscous
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.leg.description import describe
from exoid.leg.lift.lumping import distribute_bodies
from exoid.leg.lift.pseudo_inertia import margins
from exoid.leg.rewriting import read_inertials
from exoid.torques import TorqueModel

SMOOTHING = 0.02
FRICTION = (Coulomb(smoothing=SMOOTHING), Viscous())
SETS = {"bleex": ("left", "cad"), "cuhk": ("right", "nominal")}


def estimate_of(leg, terms=FRICTION, *, rigid=None, std=0.02, seed=0, **values):
    """An estimate near the leg's own parameters, other terms at random and positive unless given."""
    model = TorqueModel(leg, terms)
    rng = np.random.default_rng(seed)
    p = len(leg.parameters)
    own = leg.parameters if rigid is None else rigid
    others = [values.get(name, value) for name, value in zip(model.names[p:], rng.uniform(0.1, 1.0, 99), strict=False)]
    every = np.concatenate([own, others])
    mixing = np.eye(len(every)) + 0.2 * rng.standard_normal((len(every),) * 2)
    root = (std * np.maximum(np.abs(every), 0.01))[:, None] * mixing
    return made(model, every, root @ root.T)


def near(leg, share=0.02, seed=1):
    """Parameters that links can have, near the leg's own: its links deformed a little."""
    rng = np.random.default_rng(seed)
    model = pin.Model(leg.model)
    for j in range(1, model.njoints):
        A = np.eye(4) + share * rng.standard_normal((4, 4))
        P = pin.PseudoInertia.FromInertia(model.inertias[j]).toMatrix()
        model.inertias[j] = pin.PseudoInertia.FromMatrix(A @ P @ A.T).toInertia()
    parameters = np.concatenate([model.inertias[j].toDynamicParameters() for j in range(1, model.njoints)])
    return leg.reduction.parameters(parameters)


def reloaded(leg, path):
    return Leg.from_urdf(path, leg.joint_names, locked=leg.locked, cumulative=leg.cumulative)


@pytest.fixture(params=SETS)
def leg(request):
    side, inertias = SETS[request.param]
    return exoid.load_leg(request.param, side, inertias)


def test_pinocchio_finds_the_estimate_again(leg, tmp_path):
    estimate = estimate_of(leg, rigid=near(leg, 0.1))
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    assert export.lift.feasible
    again = reloaded(leg, export.urdf)
    np.testing.assert_allclose(again.parameters, estimate.leg.parameters, rtol=1e-12, atol=1e-14)
    q, v, a = motion_within(leg)
    np.testing.assert_allclose(again.inverse_dynamics(q, v, a), estimate.leg.inverse_dynamics(q, v, a), atol=1e-9)


ROBOTS_TO_TRY = {  # joints that move, and locked positions of others
    "ur5": (None, {}),
    "panda": (tuple(f"panda_joint{k}" for k in range(1, 8)), {"panda_finger_joint1": 0.02}),
    "z1": (("joint2", "joint3", "jointGripper"), {"joint1": 0.4, "joint4": -0.5}),
    "tiago_no_hand": (("torso_lift_joint", "arm_1_joint", "arm_3_joint"), {"arm_2_joint": 0.7, "arm_4_joint": 0.3}),
}


@pytest.mark.parametrize("robot", ROBOTS_TO_TRY)
def test_robots_with_fixed_and_locked_links_come_back_exactly(robot, tmp_path):
    joints, locked = ROBOTS_TO_TRY[robot]
    leg = Leg.from_urdf(urdf_of(robot), joints, locked=locked)
    estimate = estimate_of(leg, rigid=near(leg, 0.05))
    export = estimate.to_urdf(tmp_path / "robot.urdf")
    assert export.lift.feasible
    again = reloaded(leg, export.urdf)
    scale = np.abs(leg.parameters).max()
    np.testing.assert_allclose(again.reduction.collect, leg.reduction.collect, atol=1e-9)
    np.testing.assert_allclose(again.parameters, estimate.leg.parameters, rtol=0, atol=1e-12 * scale)
    q, v, a = motion_within(leg)
    np.testing.assert_allclose(again.inverse_dynamics(q, v, a), estimate.leg.inverse_dynamics(q, v, a), atol=1e-9)
    written = read_inertials(again.description)
    for link in export.changed_links:
        assert margins(written[link])[0] > 0.0


@pytest.mark.parametrize("angle", [0.0, 0.3, -0.7])
def test_a_locked_foot_keeps_its_inertia_and_the_shank_gets_the_rest(tmp_path, angle):
    leg = Leg.from_urdf(urdf_folder() / URDFS["bleex", "cad"], ("left_hip", "left_knee"), locked={"left_ankle": angle})
    estimate = estimate_of(leg, rigid=near(leg, 0.02))
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    assert export.changed_links == ("left_thigh", "left_shank")
    again = reloaded(leg, export.urdf)
    np.testing.assert_allclose(again.parameters, estimate.leg.parameters, rtol=1e-12)
    foot = read_inertials(leg.description)["left_foot"]
    np.testing.assert_array_equal(read_inertials(again.description)["left_foot"], foot)


def test_what_is_locked_gives_way_where_the_link_itself_cannot(tmp_path):
    """A shank with foot that weighs as much as the foot alone: both are changed alike, and their sum is exact."""
    leg = Leg.from_urdf(urdf_folder() / URDFS["bleex", "cad"], ("left_hip", "left_knee"), locked={"left_ankle": 0.3})
    bodies = np.array([inertia.toDynamicParameters() for inertia in list(leg.model.inertias)[1:]])
    bodies[1] *= 0.3
    shares = distribute_bodies(leg, bodies)
    assert set(shares) == {"left_thigh", "left_shank", "left_foot"}
    assert all(margins(parameters)[0] > 0.0 for parameters in shares.values())
    estimate = estimate_of(leg, rigid=leg.reduction.parameters(bodies.ravel()))
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    np.testing.assert_allclose(reloaded(leg, export.urdf).parameters, estimate.leg.parameters, rtol=1e-12)


def without_numbers(text, links, joints):
    """Everything but the inertia of links and the <dynamics> of joints, in canonical form."""
    root = etree.fromstring(text.encode())
    for link in links:
        root.find(f"link[@name='{link}']").remove(root.find(f"link[@name='{link}']/inertial"))
    for joint in joints:
        dynamics = root.find(f"joint[@name='{joint}']/dynamics")
        if dynamics is not None:
            dynamics.getparent().remove(dynamics)
    for element in root.iter():
        element.tail = element.text = (element.text or "").strip() or None
    return etree.tostring(root, method="c14n", with_comments=True)


def test_all_else_stays_as_it_was(leg, tmp_path):
    export = estimate_of(leg).to_urdf(tmp_path / "leg.urdf")
    before, after = leg.description.text, export.urdf.read_text(encoding="utf-8")
    parts = (export.changed_links, leg.joint_names)
    assert export.changed_links == leg.link_names
    assert without_numbers(before, *parts) == without_numbers(after, *parts)
    comments = [str(c) for c in etree.fromstring(before.encode()).xpath("//comment()")]
    found = [str(c) for c in etree.fromstring(after.encode()).xpath("//comment()")]
    assert found[1:] == comments
    assert "exoid: <inertial> of" in found[0]
    other = next(link for link in read_inertials(leg.description) if link not in leg.link_names)
    np.testing.assert_array_equal(read_inertials(describe(after))[other], read_inertials(leg.description)[other])


def test_inertia_and_friction_are_added_where_there_are_none(tmp_path):
    """A joint without <dynamics>, read back by a library of its own."""
    leg = exoid.load_leg("bleex")
    root = etree.fromstring(leg.description.text.encode())
    for dynamics in root.findall("joint/dynamics"):
        dynamics.getparent().remove(dynamics)
    leg = Leg.from_description(describe(etree.tostring(root, encoding="unicode"), "bare.urdf"), leg.joint_names)
    estimate = estimate_of(leg, rigid=near(leg))
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    robot = yourdfpy.URDF.load(str(export.urdf), load_meshes=False)
    for joint, label in zip(leg.joint_names, leg.joint_labels, strict=True):
        dynamics = robot.joint_map[joint].dynamics
        assert float(dynamics.friction) == estimate.value(f"c0_{label}")
        assert float(dynamics.damping) == estimate.value(f"d_{label}")
    model = reloaded(leg, export.urdf).model
    for j, link in enumerate(leg.link_names, start=1):
        inertial = robot.link_map[link].inertial
        assert inertial.mass == pytest.approx(model.inertias[j].mass, rel=1e-15)
        np.testing.assert_allclose(inertial.origin[:3, 3], model.inertias[j].lever, atol=1e-15)
        np.testing.assert_allclose(inertial.inertia, model.inertias[j].inertia, atol=1e-15)
    assert "\n    <dynamics" in export.urdf.read_text(encoding="utf-8")


def test_friction_that_feeds_energy_in_is_zero_in_the_urdf(tmp_path):
    leg = exoid.load_leg("cuhk")
    export = estimate_of(leg, c0_hip=-0.5, d_knee=-0.1).to_urdf(tmp_path / "leg.urdf")
    assert export.not_dissipative == ("c0_hip", "d_knee")
    root = etree.parse(str(export.urdf)).getroot()
    assert root.find("joint[@name='left_hip']/dynamics").get("friction") == "0.0"
    assert root.find("joint[@name='left_knee']/dynamics").get("damping") == "0.0"
    assert "c0_hip, d_knee below zero" in str(export)
    mujoco.MjModel.from_xml_path(str(export.urdf))


def test_an_estimate_that_cannot_exist_moves_with_its_other_terms_and_says_by_how_much(tmp_path):
    leg = exoid.load_leg("bleex")
    rigid = leg.parameters.copy()
    rigid[-1] *= -0.5
    estimate = estimate_of(leg, rigid=rigid, std=0.1)
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    assert not export.lift.feasible
    again = reloaded(leg, export.urdf)
    np.testing.assert_allclose(again.parameters, export.lift.values, rtol=1e-9)
    text = str(export)
    assert f"are {export.lift.distance:.3g} std away" in text
    change = export.values - estimate.values
    pull = np.linalg.solve(estimate.covariance, change)
    np.testing.assert_allclose(pull[9:], 0.0, atol=1e-6 * np.abs(pull).max())
    assert change @ pull == pytest.approx(export.lift.distance**2, rel=1e-6)
    for j in range(1, 4):
        a, b, c = np.linalg.eigvalsh(again.model.inertias[j].inertia)
        assert 0.0 < a <= b <= c < a + b
    mujoco.MjModel.from_xml_path(str(export.urdf))
