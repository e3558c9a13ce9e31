"""A cut-off that leaves noise of the angles in the accelerations: named where it moves parameters, and only there."""

from dataclasses import replace

import numpy as np
import pytest
from swings import TERMS, Swing, holds

import exoid
from exoid.experiments import ground
from exoid.signals import FiniteDifference

SWING = Swing(exoid.load_leg("cuhk"), 100.0, smoothing=0.015)


def found(noise, seed=1000, **options):
    """Findings of the kind, in a log with noise of its angles [rad]."""
    rng = np.random.default_rng(seed)
    log = replace(SWING.with_noise(rng, 0.05), v=None, a=None)
    log = replace(log, q=log.q + noise * rng.standard_normal(log.q.shape))
    estimate = exoid.identify(SWING.leg, log, **options)
    return [one for one in estimate.findings if one.kind == "noisy-angles"]


@pytest.mark.parametrize(
    ("options", "severity"), [({"cutoff": 20.0}, "warning"), ({"preparation": FiniteDifference()}, "error")], ids=str
)
def test_noise_that_shrinks_parameters_is_named_with_them(options, severity):
    (finding,) = found(2e-3, **options)
    assert finding.severity == severity
    assert "J1" in finding.parameters


@pytest.mark.parametrize(("noise", "cutoff"), [(0.0, 20.0), (1e-6, 20.0), (1e-4, 5.0), (2e-3, None)])
def test_a_filter_that_takes_the_noise_out_has_none(noise, cutoff):
    assert not found(noise, cutoff=cutoff)


def test_many_logs_on_disk_without_noise_have_none(tmp_path):
    """A few of them have another solution than all, which is no noise of the angles."""
    swing = Swing(SWING.leg, 100.0, 5.0, smoothing=0.015)
    for seed in range(100):
        log = swing.with_noise(np.random.default_rng(seed), 0.3)
        replace(log, v=None, a=None).to_csv(tmp_path / f"{seed}.csv")
    estimate = exoid.identify(swing.leg, exoid.Recordings.from_folder(tmp_path), TERMS, cutoff=5.0)
    assert not [one for one in estimate.findings if one.kind == "noisy-angles"]


@pytest.mark.parametrize(("base", "repeats"), [(1.0, True), (0.4713, False)])
def test_rounding_that_is_the_same_in_each_stride_is_part_of_intervals(base, repeats):
    """Each of 40 strides has the same errors: 6 of 10 intervals held, and nothing said so."""
    leg, count = exoid.load_leg("cuhk"), 2.0 * np.pi / 4096
    swing, held = Swing(leg, 100.0, 40.0, base=base, smoothing=0.015), []
    for seed in range(3):
        log = replace(swing.with_noise(np.random.default_rng(seed), 0.05), v=None, a=None)
        estimate = exoid.identify(leg, replace(log, q=count * np.round(log.q / count)), TERMS)
        found = [one for one in estimate.findings if one.kind == "noisy-angles"]
        assert bool(found) == repeats
        assert {one.severity for one in found} <= {"info"}
        held.append(holds(estimate, swing.truth))
    assert np.mean(held) >= 0.9


@pytest.mark.nightly
def test_a_walk_behind_40_hz_has_it_and_behind_the_chosen_cutoff_not():
    """X was 3.5 % too small, half of the intervals failed, and nothing said so."""
    leg, log = (
        exoid.load_exo("bleex", base="floating"),
        ground.walking(ground.bleex_machine(), 5.0).recording(seed=1002),
    )
    terms = (exoid.Coulomb(smoothing=0.02), exoid.Viscous(), exoid.Armature())
    for cutoff, named in ((40.0, True), (8.0, False)):
        estimate = exoid.identify(leg, log, terms, cutoff=cutoff)
        assert named == any(one.kind == "noisy-angles" for one in estimate.findings)
