"""Friction of another form at a leg that stands: it is named where it acts, and bands hold beyond the training."""

import dataclasses

import numpy as np
import pytest
from proving_ground.machine import draw
from proving_ground.simulate import simulate
from standing import TERMS, friction, session

import exoid

pytestmark = pytest.mark.slow


def with_stribeck(log, joint, size):
    """The same motion with friction that falls with speed at one joint."""
    v = np.gradient(log.q[:, joint], log.time)
    more = size * np.tanh(v / 0.02) * np.exp(-((v / 0.15) ** 2))
    return dataclasses.replace(log, tau=log.tau + more[:, np.newaxis] * (np.arange(log.tau.shape[1]) == joint))


@pytest.mark.parametrize("joint", [None, 1, 2])
def test_friction_of_another_form_is_named_at_its_joint(exo, joint):
    """Rows of closed chains mix all joints, and still tell them apart."""
    logs = [one.recording for one in session(exo, 40, seconds=8.0, noise=0.4, encoder=1e-4, friction=friction)]
    spoilt = logs if joint is None else [with_stribeck(log, joint, 2.0) for log in logs]
    found = [one for one in exoid.identify(exo, spoilt, TERMS).findings if one.kind == "unmodelled-friction"]
    assert [one.joint for one in found] == ([] if joint is None else [exo.joint_names[joint]])
    assert all("Stribeck" in one.message and one.value > 0.4 for one in found)


def test_bands_hold_on_unlike_motion_of_a_machine_on_a_load_cell():
    """Without doubt about friction they held 65 % at the first joint, whose friction grows with its load."""
    machine = draw(25)  # learns from short moves between stops, and is judged on sines
    log, other = simulate(machine, 12.0).recording, simulate(machine, 6.0, test=True).recording
    estimate = exoid.identify(machine.leg(), log)
    narrow = exoid.validate(dataclasses.replace(estimate, model_error=None), other)
    now = exoid.validate(estimate, other)
    print(f"inside the band {now.coverage.round(2)}, without the model error {narrow.coverage.round(2)}")
    assert narrow.coverage.min() < 0.7
    assert now.coverage.min() > 0.9
    assert "extrapolation" in {one.kind for one in now.findings}
    (first, *_) = [one for one in estimate.findings if one.kind == "unmodelled-friction"]
    assert (first.joint, "load" in first.message) == ("j1", True)
    assert 0.4 < first.value < 1.0  # of the residual of its joint: rows of the base have none of it
