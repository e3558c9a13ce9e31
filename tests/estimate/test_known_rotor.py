"""A known rotor of the first joint is no part of J1, and is left out of the exported thigh."""

import numpy as np
import pytest
from lxml import etree
from made_estimates import from_file
from swings import harmonics, log_of
from unchecked import identify

import exoid
from exoid import Armature, Leg

ROTOR = 0.05


@pytest.fixture(scope="module")
def known(data):
    return exoid.identify(data.leg, data.train, known={"Ia_hip": ROTOR})


def motion(joints, samples=40):
    return np.random.default_rng(0).standard_normal((3, samples, joints))


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ["wls", "huber", "ml", "ols"])
def test_a_known_rotor_is_subtracted_from_what_it_is_merged_into(data, estimator):
    without = identify(data.leg, data.train, estimator=estimator)
    with_ = identify(data.leg, data.train, estimator=estimator, known={"Ia_hip": ROTOR})
    tolerance = 1e-7 if estimator == "ml" else 1e-12  # which stops when steps are small
    assert [one.name for one in without.regrouped] == ["Ia_hip"]
    assert with_.regrouped == ()
    assert with_["Ia_hip"].value == ROTOR
    assert with_["Ia_hip"].std == 0.0
    assert with_["Ia_hip"].identifiability == "known"
    assert with_["J1"].value == pytest.approx(without["J1"].value - ROTOR, abs=tolerance)
    assert with_["J1"].std == pytest.approx(without["J1"].std, rel=1e-3)
    for name in without.names:
        if name != "J1":
            assert with_[name].value == pytest.approx(without[name].value, abs=1e2 * tolerance)
    np.testing.assert_allclose(with_.torque(*motion(3)), without.torque(*motion(3)), rtol=0, atol=1e2 * tolerance)


def test_a_file_keeps_it(known, tmp_path):
    again = from_file(known, tmp_path)
    assert again.names == known.names
    assert again.regrouped == ()
    assert again["Ia_hip"].identifiability == "known"
    np.testing.assert_array_equal(again.torque(*motion(3)), known.torque(*motion(3)))


def test_the_exported_thigh_is_without_it(known, estimate, tmp_path):
    export = known.to_urdf(tmp_path / "leg.urdf")
    assert "Ia_hip" in export.left_out
    joints = known.joint_names
    read = exoid.Leg.from_urdf(export.urdf, joints)
    assert read.parameters[2] == pytest.approx(estimate["J1"].value - ROTOR, rel=1e-12)
    with_rotor = exoid.Leg.from_urdf(estimate.to_urdf(tmp_path / "merged.urdf").urdf, joints)
    assert with_rotor.parameters[2] == pytest.approx(estimate["J1"].value, rel=1e-12)
    q, v, a = motion(3)
    torque = read.inverse_dynamics(q, v, a) + [ROTOR, 0.0, 0.0] * a
    np.testing.assert_allclose(torque, with_rotor.inverse_dynamics(q, v, a), atol=1e-11)


BODY = (
    '<inertial><origin xyz="0.02 0.03 -0.15"/><mass value="3"/>'
    '<inertia ixx="0.06" ixy="0.002" ixz="0" iyy="0.05" iyz="0" izz="0.02"/></inertial>'
)


def arm(right_angle):
    """Two axes at right angles, so that the second rotor merges as well."""
    text = (
        f'<robot name="arm"><link name="a"/><link name="b">{BODY}</link><link name="c">{BODY}</link>'
        '<joint name="one" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
        f'<joint name="two" type="continuous"><origin xyz="0 0 0.3" rpy="{right_angle} 0.0 0.4"/>'
        '<parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint></robot>'
    )
    root = etree.fromstring(text)
    return Leg.from_description(exoid.leg.description.describe(etree.tostring(root, encoding="unicode"), "arm.urdf"))


@pytest.mark.parametrize("right_angle", ["1.5708", "1.570796", "1.57", "1.57080001", "1.5709"])
def test_rounding_of_a_right_angle_gives_no_rotor_inertia_of_tons(right_angle):
    """The finding: −90 572 ± 38 364 kg·m² for π/2 written as 1.5708."""
    leg = arm(right_angle)
    rng = np.random.default_rng(1)
    time = np.arange(4000) / 200.0
    w = 2.0 * np.pi * np.array([0.2, 0.5, 0.9])
    size, phase = rng.uniform(0.2, 0.5, (2, 3)), rng.uniform(0.0, 6.0, (2, 3))
    q, v, a = harmonics(time, size, w, phase)
    recording = log_of(leg, time, (q, v, a), 0.1 * a, 0.05, rng, exact=True)
    estimate = exoid.identify(leg, recording, (Armature(),))
    assert [one.name for one in estimate.regrouped] == ["Ia_one", "Ia_two"]
    assert (np.abs(estimate.values) < 10.0).all()
    assert (estimate.std < 0.01).all()
    known = exoid.identify(leg, recording, (Armature(),), known={"Ia_one": 0.1, "Ia_two": 0.1})
    inertias = [k for k, name in enumerate(leg.parameter_names) if name.startswith("I")]
    np.testing.assert_allclose(known.values[inertias], leg.parameters[inertias], rtol=0, atol=0.01)
