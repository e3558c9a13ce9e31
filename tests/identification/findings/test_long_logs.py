"""A fault of seconds in a log of minutes: named wherever it is."""

from dataclasses import replace

import numpy as np
import pytest
from swings import Swing

import exoid

LEG, RATE = exoid.load_leg("cuhk"), 500.0
LOG = replace(Swing(LEG, RATE, 220.0, smoothing=0.015).with_noise(np.random.default_rng(1000), 0.3), v=None, a=None)


@pytest.mark.parametrize("second", [37, 101, 219])
def test_an_angle_that_freezes_for_a_second_is_named(second):
    q, start = LOG.q.copy(), int((second - 1) * RATE)
    q[start : start + int(RATE), 0] = q[start, 0]
    named = [one for one in exoid.identify(LEG, replace(LOG, q=q)).findings if one.kind == "stuck-channel"]
    assert [one.joint for one in named] == ["left_hip"]
    assert named[0].severity == "error"
    assert named[0].value == pytest.approx(1.0, abs=0.01)


def test_a_log_of_minutes_without_a_fault_has_no_finding():
    assert not exoid.identify(LEG, LOG).findings
