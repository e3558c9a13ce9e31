"""The ends of a record, where a zero-phase filter has to invent what came before, must not reach the estimate."""

import numpy as np
import pytest
from swings import TERMS, Swing, WithEdges
from unchecked import identify

import exoid

LEGS = (("left", "cad"), ("left", "identified"), ("right", "identified"))


def largest_error(swing, **options):
    estimate = identify(swing.leg, swing.encoders_only(), TERMS, **options)
    return np.abs(estimate.values / swing.truth - 1.0).max()


def start_mid_motion(swing):
    _, v, a = swing.motion
    return min(np.abs(v[[0, -1]]).max(), np.abs(a[[0, -1]]).max()) > 0.1


@pytest.mark.parametrize("rate", [500.0, 100.0])
@pytest.mark.parametrize(("side", "inertias"), LEGS)
def test_keeping_the_ends_must_err_grossly(side, inertias, rate):
    """The same with motions reflected at the ends: one parameter at least is several percent off."""
    swing = Swing(exoid.load_leg("bleex", side, inertias), rate, 20.0, 2)
    assert largest_error(swing, preparation=WithEdges()) > 0.02
    assert largest_error(swing, preparation=WithEdges()) > 1e3 * largest_error(swing)


@pytest.mark.parametrize(("seconds", "bound"), [(6.0, 1e-4), (3.0, 1e-4), (1.5, 1e-3)])
def test_the_ends_do_not_matter_however_short_the_record(seconds, bound):
    """Harmonics up to 2.5 Hz, the fastest at a third of the cut-off; found: 2e-5, 3e-5 and 2e-4."""
    for seed in (1, 2, 3):
        swing = Swing(exoid.load_leg("bleex"), 200.0, seconds, seed, base=0.5)
        assert start_mid_motion(swing)
        assert largest_error(swing) < bound


def test_a_spike_outside_the_valid_rows_does_not_move_the_estimate_at_all():
    """Torques that are not valid are not filtered either."""
    swing = Swing(exoid.load_leg("bleex"))
    tau = swing.torque.copy()
    tau[:3] += 5.0
    spiked, plain = (
        exoid.identify(swing.leg, swing.recording(v=None, a=None, tau=each), TERMS) for each in (tau, swing.torque)
    )
    np.testing.assert_array_equal(spiked.values, plain.values)
