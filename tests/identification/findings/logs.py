"""Logs without faults, and the finding of a kind in those of a fault."""

import dataclasses
from functools import cache

import numpy as np
from swings import Swing

import exoid


@cache
def clean(name="bleex", seed=1, seconds=30.0):
    """Leg and log: exact torques with white noise of one percent, angles of 18 bits."""
    leg = exoid.load_leg(name)
    swing = Swing(leg, seconds=seconds, seed=seed, smoothing=0.015)
    rng = np.random.default_rng(seed)
    noise = 0.01 * swing.torque.std(axis=0) * rng.standard_normal(swing.torque.shape)
    quantum = 2.0 * np.pi / 2**18  # coarser rounding, the same every 10 s, is a finding
    q = quantum * np.round(swing.motion[0] / quantum)
    return leg, swing.recording(q=q, v=None, a=None, tau=swing.torque + noise)


def with_column(recording, quantity, joint, change):
    """Change the column of one joint."""
    x = np.array(getattr(recording, quantity))
    x[:, joint] = change(x[:, joint])
    return dataclasses.replace(recording, **{quantity: x})


def kinds(findings):
    """Kinds of findings that are more than information."""
    return {finding.kind for finding in findings if finding.severity != "info"}


def of_kind(findings, kind):
    """The one finding of a kind."""
    (found,) = (finding for finding in findings if finding.kind == kind)
    return found
