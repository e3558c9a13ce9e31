"""What drives cost on the virtual rig: cylinders of BLEEX, an attachment point that is off, and a coupled wrist.

CI runs few seeds; ``python scripts/study_drives.py`` prints the tables of docs/drives.md.
"""

import os

import numpy as np
import pytest
import study_drives as study

import exoid
from exoid.actuators import Actuators, read_actuators

FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def run():
    """A leg of BLEEX in motion."""
    return study.bleex_run(1, duration=8.0)


@pytest.fixture(scope="module")
def drives(run):
    return read_actuators("bleex", run.plant.leg)


@pytest.fixture(scope="module")
def log(run, drives):
    """Forces of the first leg."""
    return study.force_log(run, 0, drives, 0)


@pytest.mark.nightly
def test_parameters_from_forces_are_as_exact_as_from_torques() -> None:
    """At most 1.2 times the error, with load cells that have noise of their own."""
    _, from_torque, from_force = study.cylinder_errors(study.bleex_run(200 if FULL else 16))
    ratio = np.sqrt(np.mean(from_force**2, axis=0) / np.mean(from_torque**2, axis=0))
    assert np.exp(np.mean(np.log(ratio))) < 1.2
    if FULL:
        assert ratio.max() < 1.2


@pytest.mark.parametrize(
    "off", [("left_hip", "second", "x"), ("left_knee", "second", "z"), ("left_ankle", "second", "z")]
)
def test_an_attachment_point_that_is_off_by_ten_millimetres_is_found(run, drives, log, off) -> None:
    found = exoid.check(run.plant.leg, log, actuators=study.displaced(drives, *off))
    (arm,) = (f for f in found if f.kind == "moment-arm")
    assert arm.joint == off[0]
    assert arm.unit == "m"
    assert 0.007 < arm.value < 0.013
    assert "measure both attachment points" in arm.remedy


@pytest.mark.nightly
def test_a_coupled_wrist_is_identified_from_motor_torques() -> None:
    limits = []
    for seed in range(8 if FULL else 1):
        run = study.wrist_run(seed, duration=120.0 if FULL else 40.0)
        leg = run.plant.leg
        drives = Actuators.of(leg, {"wrist": study.DIFFERENTIAL})
        estimate = exoid.identify(leg, study.wrist_log(run, drives), check=False, actuators=drives)
        truth = study.wrist_truth(estimate.model)
        asked = [k for k, name in enumerate(estimate.names) if not name.startswith("offset")]
        limits.append(np.abs(estimate.values - truth)[asked] / np.abs(truth[asked]))
    assert np.quantile(limits, 0.95, axis=0).max() < 0.02
