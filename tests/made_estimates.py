"""Estimates that are made by hand, of numbers that a test writes, and motions within the limits of their legs."""

from dataclasses import replace

import numpy as np

from exoid import Estimate
from exoid.signals import ZeroPhase


def made(model, values, covariance, **changes):
    """An estimate of these values, with other fields if they are given."""
    joints = np.ones(len(model.leg.joint_names))
    return replace(Estimate(model, values, covariance, 10.0, 100.0, joints, "ols", ZeroPhase(5.0)), **changes)


def from_file(estimate, folder):
    """The estimate, written to a file and read again."""
    estimate.save(folder / "est.json")
    return Estimate.load(folder / "est.json")


def motion_within(leg, samples=20, margin=0.0):
    """Random angles within the limits of the joints, velocities and accelerations."""
    rng = np.random.default_rng(2)
    lower, upper = np.maximum(leg.limits.lower, -2.0), np.minimum(leg.limits.upper, 2.0)
    room = margin * (upper - lower)
    q = rng.uniform(lower + room, upper - room, (samples, len(leg.joint_names)))
    return q, *(rng.uniform(-1, 1, (2, *q.shape)) * np.array([4.0, 15.0])[:, None, None])
