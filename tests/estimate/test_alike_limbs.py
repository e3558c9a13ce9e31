"""Limbs that are alike: equal ones share parameters, others are named, and other designs are refused."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from lxml import etree
from public_robots import urdf_of
from swings import harmonics

import exoid
from exoid.errors import BadArgumentError
from exoid.estimate.limbs import share_alike
from exoid.leg.description import describe

LIMBS = ("LF", "RF", "LH", "RH")


@cache
def quadruped():
    return exoid.Leg.from_urdf(urdf_of("anymal"), base="floating")


def log(leg, rng, *, noise=0.02):
    """Swings of BLEEX's or another machine's joints on a base that is held, 20 s."""
    time = np.arange(0.0, 20.0, 0.005)
    phase = rng.uniform(0.0, 6.0, (3, len(leg.joint_names)))
    q, v, a = harmonics(time, 0.3, 2.0 * np.pi * np.array([0.23, 0.61, 1.1]), phase.T)
    tau = leg.inverse_dynamics(q, v, a) + 0.3 * np.sign(v) + 0.2 * v
    tau += noise * tau.std(axis=0) * rng.standard_normal(tau.shape)
    return exoid.Recording(time, q, tau=tau, joint_names=leg.joint_names)


@cache
def estimate(share=1.0):
    """Four legs on a base that is held; the right thigh in front weighs more or less."""
    text = quadruped().description.text
    place = text.index("<mass", text.index('name="RF_THIGH"'))
    old = text[place : text.index("/>", place)]
    mass = float(old.split('"')[1])
    text = text[:place] + old.replace(old.split('"')[1], repr(share * mass)) + text[place + len(old) :]
    leg = exoid.Leg.from_description(describe(text, "anymal.urdf"))
    terms = (exoid.Coulomb(), exoid.Viscous())
    return leg, exoid.identify(leg, log(leg, np.random.default_rng(0)), terms, check=False)


def kinds(found):
    return {
        each.message.split()[2]: each.kind for each in found.findings if "alike" in each.kind or "unlike" in each.kind
    }


@pytest.mark.slow
def test_equal_limbs_share_parameters_and_are_more_certain():
    leg, alone = estimate()
    found = share_alike(alone, LIMBS)
    assert kinds(found) == dict.fromkeys(LIMBS[1:], "alike-limbs")
    count = len(leg.parameter_names)
    error = np.abs(found.values[:count] - leg.parameters)
    assert np.mean(error < 1.96 * found.std[:count]) > 0.88
    assert np.median(found.std / alone.std) < 0.6
    values = dict(zip(found.names, found.values, strict=True))
    for suffix in ("HAA", "HFE", "KFE"):
        assert np.ptp([values[f"c0_{limb}_{suffix}"] for limb in LIMBS]) < 1e-9
    # legs are mirror images: what points to the side has the other sign
    assert values["mcx_LF_SHANK"] == pytest.approx(-values["mcx_LH_SHANK"], abs=1e-9)
    assert values["mcx_LF_SHANK"] == pytest.approx(values["mcx_RF_SHANK"], abs=1e-9)


@pytest.mark.slow
def test_equal_limbs_are_said_to_differ_as_rarely_as_stated():
    leg, alone = estimate()
    rng, C = np.random.default_rng(1), alone.covariance
    drawn = rng.multivariate_normal(np.concatenate([leg.parameters, np.repeat([0.3, 0.2], 12)]), C, 300)
    different = [len(set(kinds(share_alike(replace(alone, values=each), LIMBS)).values())) > 1 for each in drawn]
    assert sum(different) <= 9  # 1 % of 300, and three standard deviations


@pytest.mark.slow
def test_a_heavier_thigh_is_named_and_keeps_its_own_parameters():
    leg, alone = estimate(1.1)
    found = share_alike(alone, LIMBS)
    assert kinds(found) == {"RF": "unlike-limbs", "LH": "alike-limbs", "RH": "alike-limbs"}
    count = len(leg.parameter_names)
    error = np.abs(found.values[:count] - leg.parameters)
    assert np.mean(error < 1.96 * found.std[:count]) > 0.88


def test_legs_of_bleex_are_alike_by_an_argument():
    exo = exoid.load_exo("bleex", inertias="cad")
    data = log(exo, np.random.default_rng(3))
    found = exoid.identify(exo, data, (exoid.Coulomb(), exoid.Viscous()), check=False, alike=("left", "right"))
    assert kinds(found) == {"right": "alike-limbs"}
    values = dict(zip(found.names, found.values, strict=True))
    pairs = [name for name in values if name.startswith("X") and name.endswith("left")]
    assert pairs
    for name in pairs:
        assert values[name] == pytest.approx(values[name.replace("left", "right")], abs=1e-9)


@pytest.fixture(scope="module")
def short():
    """Estimate of two legs whose right shank is 2 cm shorter."""
    description = exoid.load_exo("bleex").description
    root = etree.fromstring(description.text.encode())
    origin = root.find("joint[@name='right_ankle']/origin")
    x, y, z = (float(value) for value in origin.get("xyz").split())
    origin.set("xyz", f"{x} {y} {z + 0.02}")
    leg = exoid.Leg.from_description(describe(etree.tostring(root, encoding="unicode"), "exo.urdf"))
    return exoid.identify(leg, log(leg, np.random.default_rng(0)), (), check=False)


WRONG = [("left", "middle"), ("left",), "left", ("left", "left"), ("left_", "right_h"), ("left", "right")]


@pytest.mark.parametrize("limbs", WRONG)
def test_limbs_that_cannot_be_alike_are_refused(short, limbs):
    with pytest.raises(BadArgumentError):
        share_alike(short, limbs)
