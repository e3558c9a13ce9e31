"""Cut-off of each joint's torque by its spectrum and that of the noise: least expected error (Mallows 1973)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import EstimateData, TorqueFilter
from exoid.signals import Recording, ZeroPhase
from exoid.signals.filters import zero_phase_gain

from .evaluation import Evaluation, evaluate

AUTO = "auto"
"""Word for a cut-off that is chosen by the data."""

SHARES = np.geomspace(1.0 / 16.0, 1.0, 33)
"""Cut-offs that are compared, over that of the estimate."""

PERIODS = 4.0
"""Periods of a cut-off that a stretch of the recording has to contain."""

NEGLIGIBLE = 1e-6
"""Gain of the estimate's filter below which nothing is left of a torque."""


class ChosenCutoffs(NamedTuple):
    """Cut-offs of a recording, (n,) each."""

    cutoff: FloatArray  # −3 dB frequency [Hz]
    lost: FloatArray  # expected RMS of the torque between this cut-off and that of the estimate [N·m]


def automatic_filter(filter_: TorqueFilter) -> ZeroPhase:
    """Check that cut-offs can be chosen below that of the estimate."""
    if not isinstance(filter_.preparation, ZeroPhase):
        raise ExoidError(
            f"the preparation of the estimate, {filter_.preparation.name}, has no cut-off to choose",
            remedy="leave cutoff out, or give one in Hz",
        )
    return filter_.preparation


def evaluate_at_best(
    estimate: EstimateData, recording: Recording, own: ZeroPhase, rate: float
) -> tuple[Evaluation, ChosenCutoffs]:
    """Compute τ_w = W β − τ, both sides of each joint behind the cut-off that is best for it."""
    whole = evaluate(estimate, recording, own, 1.0)
    chosen = choose_cutoffs(whole, own, rate)
    found = {own.cutoff: whole}
    for cutoff in {*chosen.cutoff.tolist()} - {own.cutoff}:
        lower = with_cutoff(own, cutoff, rate)
        bandwidth = lower.independent_fraction(rate) / own.independent_fraction(rate)
        found[cutoff] = evaluate(estimate, recording, lower, bandwidth)
    each = joined([found[cutoff] for cutoff in chosen.cutoff.tolist()], rate)
    return each._replace(ranges=whole.ranges, bodies=whole.bodies), chosen


def choose_cutoffs(found: Evaluation, own: ZeroPhase, rate: float) -> ChosenCutoffs:
    """Choose the cut-off of each joint that has the least expected error."""
    # The torque behind the estimate's filter H is y = H (τ_w + e), with white noise e. Behind a lower cut-off
    # it is G y. The expected mean square of G y − H τ_w is, up to a constant,
    #
    #     R = Σ (1 − G)² (P_y − P_e) + G² P_e,
    #
    # with the spectra P_y of y and P_e of the noise H e, which is known from the training. The error counts against the
    # torque behind the estimate's own filter: what a lower cut-off takes of the wearer's torque is an error too.
    joints = found.torque.shape[1]
    risk, lost, weight = np.zeros((len(SHARES), joints)), np.zeros((len(SHARES), joints)), 0
    longest = 0
    for start, stop in _stretches(found.time, rate):
        y = found.torque[start:stop]
        frequency = np.asarray(np.fft.rfftfreq(len(y), 1.0 / rate), dtype=np.float64)
        window = np.hanning(len(y))[:, None]
        P_y = np.abs(np.fft.rfft((y - y.mean(axis=0)) * window, axis=0)) ** 2 / (window**2).sum() / len(y)
        P_y[1 : (len(y) + 1) // 2] *= 2.0
        H = zero_phase_gain(frequency, rate, own.cutoff, own.order)
        P_e = (H**2 / (H**2).sum())[:, None] * found.noise
        for k, share in enumerate(SHARES):
            lower = zero_phase_gain(frequency, rate, share * own.cutoff, own.order)
            G = np.divide(lower, H, out=np.zeros_like(H), where=H > NEGLIGIBLE)[:, None]
            taken = ((1.0 - G) ** 2 * (P_y - P_e)).sum(axis=0)
            lost[k] += len(y) * taken
            risk[k] += len(y) * (taken + (G**2 * P_e).sum(axis=0))
        weight, longest = weight + len(y), max(longest, len(y))
    risk[SHARES * own.cutoff * longest < PERIODS * rate] = np.inf
    risk[-1, ~np.isfinite(risk).any(axis=0)] = 0.0  # too short, or not measured
    best = np.argmin(np.where(np.isnan(risk), np.inf, risk), axis=0)
    of_best = np.nan_to_num(lost[best, np.arange(joints)]) / max(weight, 1)
    return ChosenCutoffs(SHARES[best] * own.cutoff, np.sqrt(np.maximum(of_best, 0.0)))


def with_cutoff(own: ZeroPhase, cutoff: float, rate: float) -> ZeroPhase:
    """Lower the cut-off of columns and torques only; angles stay as they are inside sines and products."""
    return replace(own, cutoff=cutoff, kinematics_cutoff=own.kinematics_cutoff_at(rate))


def joined(parts: list[Evaluation], rate: float) -> Evaluation:
    """Take each joint from an evaluation of its own, at the samples that all of them have."""
    places = [np.rint(part.time * rate).astype(np.int64) for part in parts]
    common = places[0]
    for other in places[1:]:
        common = np.intersect1d(common, other)
    if not len(common):
        raise ExoidError("no sample is far enough from the ends of the recording", remedy="record longer")
    used = [np.searchsorted(place, common) for place in places]

    def columns(name: str) -> FloatArray:
        each = zip(parts, used, strict=True)
        return np.column_stack([getattr(part, name)[rows, j] for j, (part, rows) in enumerate(each)])

    return Evaluation(
        parts[0].time[used[0]],
        columns("torque"),
        columns("predicted"),
        columns("variance"),
        np.array([part.noise[j] for j, part in enumerate(parts)]),
        parts[0].ranges,
        parts[0].bodies,
    )


def _stretches(time: FloatArray, rate: float) -> Iterator[tuple[int, int]]:
    """Stretches of samples without a gap."""
    gaps = np.flatnonzero(np.diff(time) > 1.5 / rate) + 1
    edges = np.array([0, *gaps, len(time)])
    yield from ((int(a), int(b)) for a, b in pairwise(edges) if b - a > 1)
