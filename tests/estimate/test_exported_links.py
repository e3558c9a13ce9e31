"""Links of exported URDFs are near the URDF's own, and simulators find the torques in them; else nothing is written."""

from functools import cache

import mujoco
import numpy as np
import pytest
import yourdfpy
from lxml import etree
from made_estimates import made, motion_within
from mujoco_torques import mujoco_model, mujoco_torque
from public_robots import urdf_of

import exoid
from exoid import Coulomb, ExoidError, Leg, Viscous
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.leg.description import describe
from exoid.leg.lift.lumping import MASS_FACTOR
from exoid.leg.lift.pseudo_inertia import margins
from exoid.leg.rewriting import read_inertials
from exoid.torques import TorqueModel

EXACT = 1e-9
"""Largest error of a torque, over the largest torque."""


def bare(path, joints, locked=None):
    """A leg whose URDF has no geometry, as simulators look for its meshes."""
    root = etree.parse(str(path)).getroot()
    for element in [*root.iter("visual"), *root.iter("collision")]:
        element.getparent().remove(element)
    return Leg.from_description(describe(etree.tostring(root, encoding="unicode"), path.name), joints, locked=locked)


LEGS = {
    "bleex": lambda: exoid.load_leg("bleex", "left", "cad"),
    "cuhk": lambda: exoid.load_leg("cuhk", "right", "nominal"),
    "locked": lambda: bare(
        urdf_folder() / URDFS["bleex", "cad"], ("left_hip", "left_knee"), {"left_ankle": 0.3}
    ),  # the foot is part of the shank
    "ur5": lambda: bare(urdf_of("ur5"), None),
    "z1": lambda: bare(urdf_of("z1"), ("joint2", "joint3", "jointGripper"), {"joint1": 0.4, "joint4": -0.5}),
}


@cache
def leg_of(name):
    return LEGS[name]()


def sizes(leg):
    return np.maximum(np.abs(leg.parameters), 0.01 * np.abs(leg.parameters).max())


def random_root(leg, rng):
    """Errors of 2 % to 300 % of every parameter, correlated at random."""
    count = len(leg.parameters)
    mixing = np.eye(count) + 0.3 * rng.standard_normal((count, count))
    share = np.exp(rng.uniform(np.log(0.02), np.log(3.0)))
    return share * sizes(leg)[:, None] * mixing / np.linalg.norm(mixing, axis=1, keepdims=True)


def ill_conditioned_root(leg, rng):
    """Errors of 1 % in one direction, and of 1e3 to 1e6 times as much in the worst."""
    count = len(leg.parameters)
    axes, _ = np.linalg.qr(rng.standard_normal((count, count)))
    return sizes(leg)[:, None] * axes * np.geomspace(0.01, 0.01 * 10.0 ** rng.uniform(3.0, 6.0), count)


KINDS = {"random": random_root, "ill-conditioned": ill_conditioned_root}


def estimate_of(leg, values, covariance):
    """An estimate of rigid bodies with these errors, and of friction without any."""
    model = TorqueModel(leg, (Coulomb(), Viscous()))
    p, P = len(values), len(model.names)
    every, spread = np.full(P, 0.3), np.zeros((P, P))
    every[:p], spread[:p, :p] = values, covariance
    spread[range(p, P), range(p, P)] = 1e-4
    return made(model, every, spread)


def noisy_estimate(leg, kind, rng, precision=1.0):
    root = KINDS[kind](leg, rng)
    values = leg.parameters + root @ rng.standard_normal(len(root))
    return estimate_of(leg, values, root @ root.T / precision**2)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LEGS)
def test_exported_links_are_near_the_urdfs_and_mujoco_finds_their_torques(name, kind, tmp_path):
    leg = leg_of(name)
    q, v, a = motion_within(leg, 10)
    before = read_inertials(leg.description)
    for seed in range(2):
        estimate = noisy_estimate(leg, kind, np.random.default_rng(seed))
        path = tmp_path / f"{seed}.urdf"
        export = estimate.to_urdf(path)
        written = read_inertials(describe(path.read_text(encoding="utf-8")))
        robot = yourdfpy.URDF.load(str(path), load_meshes=False)
        for mass in export.masses:
            assert 1.0 / MASS_FACTOR <= written[mass.link][0] / before[mass.link][0] <= MASS_FACTOR
            assert margins(written[mass.link])[0] > 0.0
            assert robot.link_map[mass.link].inertial.mass == pytest.approx(mass.after)
        expected = leg.with_parameters(export.lift.values).inverse_dynamics(q, v, a)
        if export.lift.feasible:
            np.testing.assert_array_equal(export.values, estimate.values)
            own = estimate.leg.inverse_dynamics(q, v, a)
            np.testing.assert_allclose(expected, own, rtol=0, atol=EXACT * np.abs(own).max())
        else:
            assert export.lift.distance < 3.0 * np.sqrt(len(leg.parameters))
        model = mujoco_model(path)
        model.dof_damping[:] = 0.0
        found = mujoco_torque(model, leg.joint_names, q, v, a, leg.locked)  # locked joints stay where they are
        np.testing.assert_allclose(found, expected, rtol=0, atol=EXACT * np.abs(expected).max())


@pytest.fixture(scope="module")
def sure_of_heavy_thigh():
    """An estimate with small errors that only links with a heavy thigh can have nearly."""
    return noisy_estimate(leg_of("bleex"), "random", np.random.default_rng(0), precision=30.0)


@pytest.mark.slow
def test_links_beyond_the_factor_are_refused_by_name_and_allowed_by_the_factor_that_is_named(
    sure_of_heavy_thigh, tmp_path
):
    with pytest.raises(ExoidError, match=r"left_thigh would weigh .* instead of 4.75 kg") as refused:
        sure_of_heavy_thigh.to_urdf(tmp_path / "leg.urdf")
    assert list(tmp_path.iterdir()) == []
    factor = float(str(refused.value).partition("mass_factor=")[2].partition(" ")[0])
    for allowed in (factor, np.inf):
        export = sure_of_heavy_thigh.to_urdf(tmp_path / "leg.urdf", mass_factor=allowed)
        assert MASS_FACTOR < max(mass.change for mass in export.masses) <= allowed
        mujoco.MjModel.from_xml_path(str(export.urdf))


def test_masses_are_printed_beside_those_of_the_urdf(sure_of_heavy_thigh, tmp_path):
    export = sure_of_heavy_thigh.to_urdf(tmp_path / "leg.urdf", mass_factor=np.inf)
    lines = [line.split() for line in str(export).splitlines()]
    assert ["mass", "[kg]", "in", "the", "URDF", "exported", "factor"] in lines
    for mass in export.masses:
        assert [mass.link, f"{mass.before:.4g}", f"{mass.after:.4g}", f"{mass.factor:.3g}"] in lines
    assert export.to_json()["masses"]["left_thigh"] == [4.75, export.masses[0].after]


def test_placeholder_masses_are_refused_until_they_are_allowed(tmp_path):
    """A URDF whose inertias are a hundredth of the truth."""
    leg = leg_of("bleex")
    root = etree.fromstring(leg.description.text.encode())
    for element in [*root.iter("mass"), *root.iter("inertia")]:
        for name, text in element.attrib.items():
            element.set(name, repr(0.01 * float(text)))
    light = Leg.from_description(describe(etree.tostring(root, encoding="unicode"), "light.urdf"), leg.joint_names)
    estimate = estimate_of(light, leg.parameters, 1e-6 * np.eye(9))
    with pytest.raises(ExoidError, match=r"light\.urdf: left_thigh would weigh .* correct the masses in the URDF"):
        estimate.to_urdf(tmp_path / "leg.urdf")
    export = estimate.to_urdf(tmp_path / "leg.urdf", mass_factor=1000.0)
    assert export.lift.feasible
    np.testing.assert_allclose(export.values, estimate.values, rtol=0, atol=0)


def test_a_light_link_that_carries_a_heavy_locked_one_keeps_its_share(tmp_path):
    """A shank of 0.1 kg with a foot of 4.1 kg: 1.4 times the body must not make the shank 17 times as heavy."""
    leg = leg_of("locked")
    root = etree.fromstring(leg.description.text.encode())
    shank = root.find("link[@name='left_shank']/inertial")
    for element in (shank.find("mass"), shank.find("inertia")):
        for name, text in element.attrib.items():
            element.set(name, repr(0.025 * float(text)))
    light = Leg.from_description(
        describe(etree.tostring(root, encoding="unicode"), "light.urdf"), leg.joint_names, locked=leg.locked
    )
    bodies = np.array([inertia.toDynamicParameters() for inertia in list(light.model.inertias)[1:]])
    bodies[1] *= 1.4
    values = light.reduction.parameters(bodies.ravel())
    export = estimate_of(light, values, 1e-8 * np.eye(len(values))).to_urdf(tmp_path / "leg.urdf")
    assert export.lift.feasible
    assert {mass.link for mass in export.masses} == {"left_thigh", "left_shank", "left_foot"}
    assert max(mass.change for mass in export.masses) < 2.0
    again = Leg.from_urdf(export.urdf, light.joint_names, locked=light.locked)
    np.testing.assert_allclose(again.parameters, values, rtol=1e-12)
