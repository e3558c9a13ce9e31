"""What the study of online estimation promises, with few seeds: ``python scripts/study_online.py`` has all."""

import os
from pathlib import Path

import numpy as np
import pytest
import study_online as study

FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"

NORM = Path(os.environ.get("EXOID_DATA_DIR") or ".") / "gait"

pytestmark = pytest.mark.slow
walks = pytest.mark.skipif(not NORM.is_dir(), reason="the norm of gait is not in $EXOID_DATA_DIR")


def test_a_payload_is_found_and_named_while_the_leg_squats():
    """The scene that needs no data."""
    (found,) = study.payload(1, "squats")
    assert abs(found.error) < min(0.1, 4.0 * found.std)
    assert found.detected == "load at left_knee"


@walks
@pytest.mark.nightly
def test_a_payload_on_the_shank_is_found_to_100_g_in_5_s():
    found = study.payload(16 if FULL else 2)
    assert np.quantile(np.abs([one.error for one in found]), 0.95) <= 0.1
    assert {one.detected for one in found} == {"load at left_knee"}


@walks
@pytest.mark.nightly
def test_friction_that_doubles_is_named_within_3_s():
    for joint, found in study.friction(16 if FULL else 1, ("hip", "knee", "ankle")).items():
        for one in found:
            assert one.detected == f"friction at left_{joint}"
            assert one.after <= 3.0


@walks
@pytest.mark.nightly
def test_nobody_moves_and_nothing_changes():
    assert study.standing(10.0 if FULL else 0.5).max() <= 1.0


@walks
@pytest.mark.nightly
def test_walking_on_raises_no_alarm():
    found = study.quiet(60.0) if FULL else study.quiet(4.5, rigs=6)
    assert not found.changes


@walks
@pytest.mark.skipif(not FULL, reason="EXOID_FULL_STUDIES=1 runs it: minutes")
def test_a_controller_with_the_estimate_tracks_like_one_that_knew():
    found = study.loop(16)
    tuned, knew = found["self-tuning"], found["feedforward that knew"]
    assert np.quantile(np.abs(tuned.mass), 0.95) <= 0.1
    assert (np.quantile(tuned.rms / knew.rms, 0.95, axis=1) <= 1.2).all()
