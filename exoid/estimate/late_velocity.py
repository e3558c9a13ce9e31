"""Logged velocities that are late or out of scale, which neither an estimate nor its validation uses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import scaled_inverse, scaled_lstsq
from exoid.signals import Recording, ZeroPhase
from exoid.signals.differentiation import difference

from .finding import Finding, Severity


def late_velocities(recording: Recording) -> Iterator[Finding]:
    """Compare logged velocities with the derivative of the angles: v = g (q̇ − d q̈)."""
    if recording.v is None:
        return
    even = recording.resampled()
    rate = even.sample_rate
    low_pass = ZeroPhase(cutoff=min(6.0, 0.15 * rate))
    edge = low_pass.edge(rate)
    if len(even) <= max(2 * edge + 20, 3.0 * rate / low_pass.cutoff) or even.v is None:  # it filters 2.6 periods
        return
    q, logged = low_pass.filter(even.q, rate), low_pass.filter(even.v, rate)
    v = difference(q, rate, 1, 4)
    a = difference(v, rate, 1, 4)
    inner = slice(edge, len(q) - edge)
    for k, joint in enumerate(even.joint_names):
        rows = np.column_stack([v[inner, k], a[inner, k], np.ones(len(q) - 2 * edge)])
        late = _delay(rows, logged[inner, k])
        if late is None or np.ptp(q[inner, k]) < 0.02:  # [rad], at a stall the derivative is noise
            continue
        gain, delay, errors = late
        is_late = abs(delay) > max(4.5 * errors[1], 1e-3)
        if is_late:
            when = "after" if delay > 0.0 else "before"
            message = f"the logged velocity comes {1e3 * delay:.3g} ms {when} the derivative of the angle"
            remedy = "leave the velocity out of the log, as is done here: it is derived from the angle without delay"
            interval = delay - 2.0 * errors[1], delay + 2.0 * errors[1]
            yield Finding("velocity-delay", joint, delay, "s", "warning", message, remedy, interval)
        # a low-pass that makes it late takes a little of its size, too
        if abs(gain - 1.0) > (0.05 if is_late else max(4.5 * errors[0], 0.01)):
            message = f"the logged velocity is {gain:.3g} times the derivative of the angle"
            remedy = "leave the velocity out of the log, as is done here, or correct its unit or sign"
            severity: Severity = "error" if abs(gain - 1.0) > 0.05 else "warning"
            yield Finding("velocity-scale", joint, gain, "1", severity, message, remedy)


def _delay(rows: FloatArray, logged: FloatArray) -> tuple[float, float, FloatArray] | None:
    """Gain, delay [s] and their standard deviations, from blocks of the record; None where nothing moves."""
    whole = scaled_lstsq(rows, logged) if min(np.std(rows[:, 0]), np.std(logged)) > 0.0 else np.zeros(2)
    gain = float(whole[0])
    if gain == 0.0:
        return None
    residual = logged - rows @ whole
    blocks = np.array_split(np.arange(len(rows)), max(4, min(20, len(rows) // 50)))
    inverse = scaled_inverse(rows.T @ rows)
    scores = np.array([rows[block].T @ residual[block] for block in blocks])
    covariance = inverse @ (scores.T @ scores) @ inverse * len(blocks) / (len(blocks) - 1)
    return gain, -float(whole[1]) / gain, np.sqrt(np.diag(covariance)) / abs(gain)
