"""The motion of a log as a reference: a smooth curve through its angles, with exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import BadArgumentError
from exoid.rig import Reference, Target
from exoid.signals import Recording, choose_preparation

DEGREE = 5
"""Degree of the polynomials, whose accelerations are smooth."""


@dataclass(frozen=True, repr=False)
class FollowedLog(Reference):
    """Motion of a log, of one rig; it rests at its ends outside the log.

    Attributes:
        curve: Angles [rad] as a spline of the time since the first sample [s].
        duration: Duration of the log [s].
    """

    curve: scipy.interpolate.BSpline
    duration: float

    @property
    def edge(self) -> float:
        """Time at each end in which velocities and accelerations are inaccurate, as the log is one-sided there [s]."""
        return DEGREE * float(self.curve.t[DEGREE + 1] - self.curve.t[DEGREE])

    def at(self, time: float) -> Target:
        """Evaluate the motion."""
        t = min(max(time, 0.0), self.duration)
        q, v, a = (self.curve(t, order)[:, np.newaxis] for order in range(3))
        return Target(q, v, a) if t == time else Target(q, np.zeros_like(q), np.zeros_like(q))


def follow_log(recording: Recording) -> FollowedLog:
    """Fit a spline to the angles of a log by least squares.

    The knots lie so close that the spline follows all frequencies below the cut-off of
    :func:`.choose_preparation`, and so far apart that it leaves out the noise above.

    Args:
        recording: The log.

    Returns:
        Its motion.

    Raises:
        ExoidError: The log is too short, or time has a gap.

    Example:
        >>> time = np.arange(500) / 100.0
        >>> log = Recording(time=time, q=np.sin(time**1.5)[:, np.newaxis], joint_names=("knee",))
        >>> abs(follow_log(log).at(3.0).q[0, 0] - np.sin(3.0**1.5)) < 1e-4
        np.True_
    """
    even = recording.resampled()
    # six knots in a period of the highest frequency that is kept, and 2.5 samples between two knots at least
    spacing = max(1.0 / (6.0 * choose_preparation([even]).cutoff), 2.5 / even.sample_rate)
    count = int(even.duration / spacing)
    if count < 1 or len(even) < count + DEGREE + 1:
        raise BadArgumentError(
            f"a log of {len(even)} samples is too short to follow",
            where=even.file_name,
            remedy="give one of several seconds",
        )
    time = even.time - even.time[0]
    inner = np.linspace(0.0, time[-1], count + 1)[1:-1]
    ends = np.zeros(DEGREE + 1)
    knots = np.concatenate([ends, inner, ends + time[-1]])
    return FollowedLog(scipy.interpolate.make_lsq_spline(time, even.q, knots, DEGREE), float(time[-1]))
