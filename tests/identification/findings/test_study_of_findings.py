"""The study of findings: each table is printed, and faults are found in its logs.

CI runs few replicates; ``python scripts/study_findings.py --seeds 20`` prints the tables.
"""

import fault_lists
import faulty_logs
import numpy as np
import pytest
import study_findings as study

import exoid


@pytest.mark.slow
@pytest.mark.parametrize("leg", ["bleex", "cuhk", "hyq"])
def test_no_parameter_stays_well_under_a_strap(leg):
    """A strap of 50 N/m between leg and frame moves parameters of all joints, and no one knows by how much."""
    which = next(k for k, one in enumerate(fault_lists.DISTURBANCES) if one.name.startswith("strap"))
    outcomes = [study.disturbed(leg, which, 50.0, seed) for seed in range(2)]
    assert all(outcome.named and outcome.well == 0.0 for outcome in outcomes)
    assert np.mean([outcome.inside for outcome in outcomes]) < 0.8


def test_there_are_25_corruptions_and_the_disturbances_of_the_page(capsys):
    assert len(fault_lists.CORRUPTIONS) >= 25
    study.main(["disturbances", "--seeds", "1", "--legs", "cuhk", "--only", "none"])
    study.main(["corruptions", "--seeds", "1", "--legs", "cuhk", "--only", "torque sign, joint 1"])
    study.main(["corruptions", "--seeds", "1", "--legs", "cuhk", "--only", "tilted", "--sizes", "4"])
    study.main(["clean", "--seeds", "1", "--legs", "cuhk"])
    printed = capsys.readouterr().out
    assert "none" in printed
    assert printed.count("all: 1/1 (100%)") == 2
    assert "false alarms, cuhk: 0/1" in printed


def findings_of_tilt(degrees, seed):
    tilted = next(one for one in fault_lists.CORRUPTIONS if one.name.startswith("base tilted"))
    bad = tilted.apply(faulty_logs.clean_log("cuhk", seed), degrees, np.random.default_rng(seed))
    return exoid.check(bad.leg, bad.recordings)


def test_faults_that_a_log_cannot_tell_apart_are_named_beside_each_other():
    """Coupling of two segments shows a tilt and a length; a small one of either fits about as well."""
    found = findings_of_tilt(2.0, 2)
    assert [finding.kind for finding in found] == ["segment-length", "gravity-direction"]
    assert "gravity-direction would explain this log about as well" in found[0].message
    assert "segment-length at left_hip would explain this log about as well" in found[1].message
    (large,) = findings_of_tilt(8.0, 2)
    assert large.kind == "gravity-direction"
    assert "as well" not in large.message


def test_segments_that_are_turned_alike_against_the_urdf_are_a_tilt():
    """The motion of this log hardly couples the segments, so that nothing else shows the tilt."""
    negative, finding = findings_of_tilt(3.0, 5)
    assert negative.kind == "negative-parameter"
    assert (finding.kind, finding.severity) == ("gravity-direction", "info")
    assert finding.value == pytest.approx(np.deg2rad(3.0), rel=0.05)
    assert finding.interval[0] < finding.value < finding.interval[1]
