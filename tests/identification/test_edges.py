"""The ends of a record, where a zero-phase filter has to invent what came before, must not reach the estimate."""

import numpy as np
import pytest
from swings import TERMS, Swing, WithEdges
from unchecked import identify

import exoid

LEGS = (("left", "cad"), ("left", "identified"), ("right", "identified"))
RECORDS = ((500.0, 20.0), (100.0, 20.0), (100.0, 60.0))


def largest_error(swing, **options):
    estimate = identify(swing.leg, swing.encoders_only(), TERMS, **options)
    return np.abs(estimate.values / swing.truth - 1.0).max()


def start_mid_motion(swing):
    _, v, a = swing.motion
    return min(np.abs(v[[0, -1]]).max(), np.abs(a[[0, -1]]).max()) > 0.1


@pytest.mark.parametrize("estimator", ["ols", "wls"])
@pytest.mark.parametrize(("rate", "seconds"), RECORDS)
@pytest.mark.parametrize(("side", "inertias"), LEGS)
def test_encoder_angles_alone_give_every_parameter_within_two_percent(side, inertias, rate, seconds, estimator):
    """Three segments with friction, five harmonics of 0.1 Hz, no velocity or acceleration logged; found: 3e-6."""
    for seed in (1, 2, 3):
        swing = Swing(exoid.load_leg("bleex", side, inertias), rate, seconds, seed)
        assert start_mid_motion(swing)
        assert largest_error(swing, estimator=estimator) < 2e-5


@pytest.mark.parametrize("rate", [500.0, 100.0])
@pytest.mark.parametrize(("side", "inertias"), LEGS)
def test_keeping_the_ends_must_err_grossly(side, inertias, rate):
    """The same with the ends left in: one parameter at least is several percent off."""
    swing = Swing(exoid.load_leg("bleex", side, inertias), rate, 20.0, 2)
    assert largest_error(swing, preparation=WithEdges()) > 0.02
    assert largest_error(swing, preparation=WithEdges()) > 1e3 * largest_error(swing)


def test_the_ends_do_not_matter_however_short_the_record():
    """Two seconds and the ends: what is left is little, but right."""
    swing = Swing(exoid.load_leg("bleex"), 200.0, 3.0, base=0.5)
    assert largest_error(swing) < 5e-3


def test_a_step_outside_the_valid_rows_does_not_move_the_estimate():
    """A torque spike in the first samples, within the stretch that is removed, has no effect to speak of."""
    swing = Swing(exoid.load_leg("bleex"))
    tau = swing.torque.copy()
    tau[:3] += 5.0
    estimate = exoid.identify(swing.leg, swing.recording(v=None, a=None, tau=tau), TERMS)
    assert np.abs(estimate.values / swing.truth - 1.0).max() < 1e-3
