"""X, Y, J of a limb or of sandbags follow from estimates of the machine alone and worn."""

import json
from dataclasses import replace

import numpy as np
import pytest
from swings import TERMS
from worn import log, swing

import exoid
from exoid import ExoidError
from exoid.control.wearer import compare_limb, identify_limb, limb_parameters, limb_recording
from exoid.control.wearer.cuffs import Cuffs
from exoid.errors import BadArgumentError
from exoid.rig import leg_with_payloads, limb_of, sandbags

SEEDS = range(6)


def estimate_of(leg, seed):
    return exoid.identify(leg, log(swing(leg, seed, seconds=60.0, base=0.2), seed=seed), TERMS)


@pytest.fixture(scope="module", params=["bleex", "cuhk"])
def leg(request):
    return exoid.load_leg(request.param)


@pytest.fixture(scope="module")
def alone(leg):
    return [estimate_of(leg, seed) for seed in SEEDS]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["limb", "sandbags"])
def test_mass_moments_to_2_and_inertias_to_5_percent_with_intervals_that_hold(leg, alone, kind):
    if kind == "limb":
        expected, worn = limb_parameters(leg), leg.with_parameters(leg.parameters + limb_of(leg).parameters)
    else:
        expected, worn = limb_parameters(leg, bodies=sandbags()), leg_with_payloads(leg, sandbags())
    found = [compare_limb(one, estimate_of(worn, 50 + seed), expected) for seed, one in zip(SEEDS, alone, strict=True)]
    names, truth = found[0].names, found[0].expected
    assert names == leg.parameter_names
    error = np.sqrt(np.mean([(each.values - truth) ** 2 for each in found], axis=0))
    of = dict(zip(names, error, strict=True))
    for name in ("X1", "X2"):
        assert of[name] < 0.02 * expected[name]
        assert of[name.replace("X", "Y")] < 0.02 * expected[name]
    for name in ("J1", "J2"):
        assert of[name] < 0.05 * expected[name]
    inside = np.mean([each.inside for each in found])
    assert inside > 0.85
    widths = np.mean([np.diff(each.interval)[:, 0] for each in found], axis=0)
    assert np.median(widths / error) < 8.0  # they are not much too wide


def test_what_a_limb_adds_is_what_pinocchio_says(leg):
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1.0, 1.0, (3, 40, len(leg.joint_names)))
    added = np.array(list(limb_parameters(leg, bodies=sandbags()).values()))
    loaded = leg_with_payloads(leg, sandbags())
    difference = loaded.inverse_dynamics(q, v, a) - leg.inverse_dynamics(q, v, a)
    assert np.allclose(leg.regressor(q, v, a) @ added, difference, atol=1e-10)


def test_a_heavier_wearer_has_a_heavier_limb(leg):
    light, heavy = limb_parameters(leg, 1.75, 60.0), limb_parameters(leg, 1.75, 90.0)
    assert list(light) == list(leg.parameter_names)
    assert heavy["X1"] == pytest.approx(1.5 * light["X1"])
    with pytest.raises(ExoidError):
        limb_parameters(leg, -1.0, 70.0)


def test_the_result_prints_itself(leg, alone):
    found = compare_limb(alone[0], alone[1], limb_parameters(leg))
    assert "expected" in str(found)
    assert "<table" in found._repr_html_()
    assert "X1" in repr(found)
    data = json.loads(json.dumps(found.to_json()))
    assert data["X1"]["interval"][0] < data["X1"]["value"] < data["X1"]["interval"][1]
    bare = compare_limb(alone[0], alone[1])
    assert "expected" not in str(bare)
    assert not any(bare.inside)
    assert bare.to_json()["X1"]["expected"] is None


def worn_log(leg, limb, stiffness, damping, seed=70, base=0.2):
    """The limb follows a swing, and the leg hangs in its cuffs: q = q_l − x with k x + d ẋ = τ_w = −RNEA_limb(q_l)."""
    motion = swing(leg, seed, seconds=60.0, base=base)
    torque = -limb.inverse_dynamics(*motion.motion)
    spectrum = np.fft.rfft(torque, axis=0)
    s = 2j * np.pi * np.fft.rfftfreq(len(torque), 1.0 / motion.rate)[:, None]
    bent = spectrum / (stiffness + damping * s)
    x, xv, xa = (np.fft.irfft(bent * s**order, len(torque), axis=0) for order in range(3))
    q, v, a = (one - other for one, other in zip(motion.motion, (x, xv, xa), strict=True))
    tau = leg.inverse_dynamics(q, v, a) + motion.coulomb * np.tanh(v / motion.smoothing) + motion.viscous * v - torque
    rng = np.random.default_rng(seed)
    noisy = tau + 0.4 * rng.standard_normal(q.shape)
    names = leg.joint_names
    return exoid.Recording(
        motion.time, q + 5e-5 * rng.standard_normal(q.shape), tau=noisy, joint_names=names
    ), motion.motion[0]


@pytest.mark.parametrize("damping", [0.0, 30.0])
def test_a_limb_in_cuffs_is_found_where_a_rigid_one_is_not(leg, alone, damping):
    limb, expected = limb_of(leg), limb_parameters(leg)
    recording, angles = worn_log(leg, limb, 1000.0, damping)
    log = limb_recording(alone[0], recording, 1000.0, damping)
    there = angles[np.searchsorted(recording.time, log.time - 5e-3)]
    inner = slice(300, -300)
    assert (
        np.abs(log.q - there)[inner].max()
        < 0.15 * np.abs(recording.q[np.searchsorted(recording.time, log.time - 5e-3)] - there)[inner].max() + 2e-3
    )
    found = identify_limb(alone[0], recording, 1000.0, damping, cuff_std=0.0, expected=expected)
    as_rigid = compare_limb(alone[0], exoid.identify(leg, recording, TERMS, check=False), expected)
    for name in ("X1", "X2"):
        k = found.names.index(name)
        assert abs(found.values[k] / expected[name] - 1.0) < 0.02
    for name in ("J1", "J2"):
        assert abs(found.values[found.names.index(name)] / expected[name] - 1.0) < 0.05
    assert np.mean(found.inside) > 0.6
    standardised = [np.sum(((each.values - each.expected) / each.std) ** 2) for each in (as_rigid, found)]
    assert standardised[0] > 3.0 * standardised[1]


@pytest.mark.parametrize(
    "cuffs", [(0.0, 0.0, 0.2), (-1.0, 0.0, 0.2), (1000.0, -1.0, 0.2), (np.nan, 0.0, 0.2), (1000.0, 0.0, -0.1)]
)
def test_impossible_cuffs_are_refused(leg, alone, cuffs):
    with pytest.raises(BadArgumentError):
        identify_limb(alone[0], log(swing(leg, 3)), cuffs[0], cuffs[1], cuff_std=cuffs[2])


def test_a_limb_needs_one_segment(leg, alone):
    parts = log(swing(leg, 3)).segments([(5.0, 12.0), (20.0, 30.0)])
    with pytest.raises(BadArgumentError):
        identify_limb(alone[0], parts, 1000.0)


@pytest.mark.parametrize("base", [0.2, 0.05], ids=["walking speed", "slow"])
def test_cuffs_that_are_20_percent_softer_than_stated_are_found_beside_the_limb(leg, alone, base):
    """Least squares without instruments would find a slow hip damped by 17 ± 2 instead of 30 N·m·s/rad."""
    expected = limb_parameters(leg)
    recording, _ = worn_log(leg, limb_of(leg), 1000.0, 30.0, base=base)
    found = identify_limb(alone[0], recording, 1200.0, 36.0, expected=expected)
    cuffs = found.cuffs
    off = np.concatenate([np.log(cuffs.stiffness / 1000.0), np.log(cuffs.damping / 30.0)])
    std = np.concatenate([cuffs.stiffness_std, cuffs.damping_std])
    assert (np.abs(off) < 2.5 * std).all()
    assert std[0] < 0.1  # the hip carries the whole limb, so that its cuff bends most
    assert (std < 0.35).all()
    assert (np.abs(found.values - found.expected) < 3.0 * found.std).all()
    assert "stiffness" in str(found)


def test_late_torques_are_named_as_an_error_that_intervals_lack(leg):
    logs = [log(swing(leg, seed, seconds=60.0, base=0.2), seed=seed) for seed in (1, 2)]
    late = [replace(one, tau=np.roll(one.tau, 1, axis=0)) for one in logs]
    first, second = (exoid.identify(leg, one, TERMS) for one in late)
    (note,) = compare_limb(first, second).notes
    assert "ms after the motion" in note
    assert "note: torques" in str(compare_limb(first, second))
    assert not compare_limb(*(exoid.identify(leg, one, TERMS) for one in logs)).notes


def test_small_damping_is_as_uncertain_as_large_damping_and_none_is_known():
    cuffs = Cuffs.of(("hip", "knee", "ankle"), 1000.0, [0.4, 40.0, 0.0], 0.2)
    np.testing.assert_array_equal(cuffs.damping_std, [0.2, 0.2, 0.0])
    assert [row[4] for row in cuffs.rows()] == ["0.08", "8", "0"]
    assert not cuffs.known
    assert Cuffs.of(("hip",), 1000.0, 5.0, 0.0).known
