"""A fault needs a size that matters, not only significance: exact logs have no trifling findings."""

import numpy as np
import pytest
from logs import clean, of_kind, with_column
from swings import Swing, late

import exoid


def exact(name="bleex"):
    """Leg and log without any noise."""
    leg = exoid.load_leg(name)
    swing = Swing(leg, seconds=30.0, seed=1, smoothing=0.015)
    return leg, swing.recording(v=None, a=None)


def tilted(log, degrees):
    return with_column(log, "q", 0, lambda x: x - np.deg2rad(degrees))


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_an_exact_log_has_no_findings(name):
    assert exoid.check(*exact(name)) == ()


def test_a_trifling_fault_of_an_exact_log_is_not_reported_and_a_small_one_is_no_error():
    leg, log = exact()
    assert exoid.check(leg, tilted(log, 0.05)) == ()
    assert exoid.check(leg, late(log, 1e-4, range(3))) == ()
    finding = of_kind(exoid.check(leg, tilted(log, 0.5)), "gravity-direction")
    assert finding.severity == "warning"
    assert abs(finding.value) == pytest.approx(np.deg2rad(0.5), rel=0.05)
    assert of_kind(exoid.check(leg, tilted(log, 10.0)), "gravity-direction").severity == "error"


def test_the_zero_of_the_last_joint_is_information_from_two_degrees_on():
    leg, log = clean("cuhk")
    finding = of_kind(exoid.check(leg, with_column(log, "q", 1, lambda x: x + np.deg2rad(2.0))), "angle-offset")
    assert (finding.joint, finding.severity) == (leg.joint_names[1], "info")
    assert finding.value == pytest.approx(np.deg2rad(2.0), rel=0.1)
    assert exoid.check(leg, with_column(log, "q", 1, lambda x: x + np.deg2rad(1.0))) == ()
