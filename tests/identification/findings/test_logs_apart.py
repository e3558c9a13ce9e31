"""One log that differs among many: named with its file, however many there are and wherever it stands."""

from dataclasses import replace

import numpy as np
import pytest
from logs import clean
from swings import TERMS, Swing

import exoid

LEG, COUNT, PLACE = exoid.load_leg("cuhk"), 30, 7
"""More logs than finer checks look at; the one at this place is not among these."""

FAULTS = {
    "sign of one torque": lambda one: replace(one, tau=one.tau * [-1.0, 1.0]),
    "scale of all": lambda one: replace(one, tau=1.5 * one.tau),
    "zero of an angle": lambda one: replace(one, q=one.q + np.array([0.0, 0.3])),
    "torques interchanged": lambda one: replace(one, tau=one.tau[:, ::-1]),
    "none": lambda one: one,
}


@pytest.mark.parametrize(
    ("fault", "terms"),
    [
        *((fault, TERMS) for fault in FAULTS),
        *((fault, ()) for fault in ("sign of one torque", "none")),
        *(pytest.param(fault, (), marks=pytest.mark.nightly) for fault in [*FAULTS][1:-1]),
    ],
)
def test_a_log_unlike_the_others_is_named(fault, terms, tmp_path):
    """Also by a model without friction, which leaves much of all logs."""
    rng = np.random.default_rng(1000)
    for k in range(COUNT):
        swing = Swing(LEG, 100.0, 3.0, base=rng.uniform(0.3, 1.2), smoothing=0.015)
        log = replace(swing.with_noise(rng, 0.3), v=None, a=None)
        (FAULTS[fault](log) if k == PLACE else log).to_csv(tmp_path / f"{k}.csv")
    found = exoid.identify(LEG, exoid.Recordings.from_folder(tmp_path), terms).findings
    named = [one.recording for one in found if one.kind == "large-residual"]
    assert named == ([] if fault == "none" else [f"{PLACE}.csv"])


def test_logs_without_noise_are_alike():
    """What the cut-off leaves of them is 3e-5 of the torque, and in one log several times that of the others."""
    rng = np.random.default_rng(3)
    swings = [Swing(LEG, 100.0, 3.0, base=rng.uniform(0.05, 1.2), smoothing=0.015) for _ in range(COUNT)]
    logs = [replace(swing.with_noise(rng, 0.0), v=None, a=None) for swing in swings]
    assert not [one for one in exoid.identify(LEG, logs, TERMS).findings if one.kind == "large-residual"]


GROSS = {  # what is wrong in one log of two: its angles, its torques, and the finding
    "sign of a torque": (lambda q: q, lambda tau: tau * [1.0, -1.0, 1.0], "torque-sign", "left_knee"),
    "torques swapped": (lambda q: q, lambda tau: tau[:, [0, 2, 1]], "joint-order", "left_knee, left_ankle"),
    "angles swapped": (lambda q: q[:, [1, 0, 2]], lambda tau: tau, "joint-order", "left_hip, left_knee"),
    "sign of an angle": (lambda q: q * [1.0, -1.0, 1.0], lambda tau: tau, "angle-sign", "left_knee"),
    "all in N·mm": (lambda q: q, lambda tau: 1e3 * tau, "torque-scale", ""),
    "one in N·mm": (lambda q: q, lambda tau: tau * [1.0, 1e3, 1.0], "torque-scale", "left_knee"),
}


@pytest.mark.parametrize("place", [0, 1])
@pytest.mark.parametrize("name", GROSS)
def test_a_gross_fault_of_one_log_of_two_is_named_there(name, place):
    """It was quadratic friction, a drive's limit or a load of tons."""
    angles, torques, kind, joint = GROSS[name]
    (leg, one), (_, other) = clean(seed=1), clean(seed=2)
    logs = [one, other]
    logs[place] = replace(logs[place], q=angles(logs[place].q), tau=torques(logs[place].tau))
    errors = {(x.kind, x.joint, x.recording) for x in exoid.check(leg, logs) if x.kind != "large-residual"}
    assert errors == {(kind, joint, f"recording {place + 1}")}


def test_a_group_whose_residuals_come_from_another_names_that():
    """N·mm in all logs of one group left 600 times the torque of the other unexplained, and this did not say why."""
    (leg, one), (_, other) = clean(seed=1), clean(seed=2)
    wrong = replace(other, tau=1e3 * other.tau)
    both = exoid.identify(leg, {"monday": one, "tuesday": wrong}, own=())
    assert "torque-scale" in {x.kind for x in both.estimates["tuesday"].findings}
    large = [x.message for x in both.estimates["monday"].findings if x.kind == "large-residual"]
    assert large
    assert all("mend torque-scale of tuesday first" in message for message in large)
