"""Other orders of a passive joint and of one that stands still: looked for with more doubt, or not at all."""

from dataclasses import replace

import numpy as np
from swings import Swing

import exoid

SWING = Swing(exoid.load_leg("bleex"), 50.0)
HIP, KNEE, ANKLE = SWING.leg.joint_names


def log(passive=()):
    recording = replace(SWING.with_noise(np.random.default_rng(1000), 0.1), v=None, a=None)
    tau = np.where(np.isin(recording.joint_names, passive), 0.0, recording.tau)
    return replace(recording, tau=tau, passive=passive)


def orders(recording):
    return [one.joint for one in exoid.check(SWING.leg, recording) if one.kind == "joint-order"]


def test_swapped_angles_of_a_passive_joint_are_found_where_the_others_fit_by_far_better():
    recording = log(passive=(ANKLE,))
    assert not orders(recording)
    assert orders(replace(recording, q=recording.q[:, [0, 2, 1]])) == [f"{KNEE}, {ANKLE}"]


def test_a_strap_does_not_swap_the_passive_joint():
    recording = log(passive=(ANKLE,))
    for size in (20.0, 60.0, 200.0):
        strap = size * np.column_stack([recording.q[:, 2], recording.q[:, 0] ** 2, 0.0 * recording.time])
        assert not any(ANKLE in joints for joints in orders(replace(recording, tau=recording.tau + strap))), size


def test_no_order_is_looked_for_at_a_joint_that_stands_still():
    recording = log()
    still = replace(recording, q=recording.q * [1.0, 1.0, 0.01])
    assert not orders(replace(still, q=still.q[:, [0, 2, 1]]))
