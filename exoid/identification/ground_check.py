"""Faults of the torques of a leg on the ground, whose rows combine joints: wrong signs, orders and delays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import rms_residual
from exoid.regression.rows import for_leg
from exoid.signals import Poses

from .estimators.by_name import find_estimator, fit_by
from .findings.kinds import KINDS
from .findings.readings import CLEARLY, FITS_BETTER, POOR, Reading, readings
from .problem import Fitted, Problem
from .row_changes import torque_delays


def torque_findings(fitted: Fitted, parts: Sequence[int]) -> Iterator[Finding]:
    """Try other signs and orders of the torques of some groups where the fit is poor; else look for delays."""
    logged = _with_torques(fitted.problem, parts, None)
    at_rest = np.zeros(len(fitted.problem.names))
    torques = _residuals(logged, parts, at_rest)
    misfits = _residuals(logged, parts, fitted.fit.solution.values)
    measured = torques > 0.0
    if (misfits[measured] > POOR * torques[measured]).any():
        best = _best_reading(logged, parts)
        if best is not None:
            names = logged.groups[parts[0]].model.names
            text = f"{best.message}: the log fits by far better"
            yield Finding(best.kind, best.joint, best.value or 1.0, "1", "error", text, best.remedy, parameters=names)
            return
    kind = KINDS["torque-delay"]
    for joint, delay, half in zip(
        logged.groups[parts[0]].model.joint_names, *torque_delays(fitted, parts), strict=True
    ):
        if abs(delay) > (kind.least or 0.0):
            text = f"the torque of {joint} comes {1e3 * abs(delay):.3g} ms {kind.signs[int(delay < 0.0)]}"
            interval = (float(delay - half), float(delay + half))
            yield Finding("torque-delay", joint, float(delay), "s", "warning", text, kind.remedy, interval)


def _best_reading(problem: Problem, parts: Sequence[int]) -> Reading | None:
    """Reading of the torques that fits by far better than the log as it is, if any."""
    plain, *others = readings(problem.groups[parts[0]].model.joint_names)
    of_torques = [one for one in others if (one.angles, one.angle_order) == (plain.angles, plain.angle_order)]
    as_logged = _misfit(problem, parts, plain)
    best, most = None, 2.0 * np.log(FITS_BETTER)
    for reading in of_torques:
        misfit = _misfit(problem, parts, reading)
        if as_logged is not None and misfit is not None and (gain := float(np.sum(np.log(as_logged / misfit)))) > most:
            best, most = reading, gain + 2.0 * np.log(CLEARLY)
    return best


def _misfit(problem: Problem, parts: Sequence[int], reading: Reading) -> FloatArray | None:
    """RMS residual of each row of some groups with torques read otherwise; None where they cannot be fitted."""
    # As in the air, all torques with the wrong sign would fit as well if friction could be negative.
    try:  # a passive joint has no torque of another
        problem = _with_torques(replace(problem, given=replace(problem.given, nonnegative=True)), parts, reading)
        values = fit_by(find_estimator("wls"), problem).solution.values
    except (ExoidError, np.linalg.LinAlgError):
        return None
    return np.maximum(_residuals(problem, parts, values), 1e-9)


def _with_torques(problem: Problem, parts: Sequence[int], reading: Reading | None) -> Problem:
    """Read the torques of some groups otherwise; None for as they are logged, with the joints of the leg."""
    groups = list(problem.groups)
    for k in parts:
        data = []
        for one in (for_leg(groups[k].model, each) for each in groups[k].data):
            if reading is None or isinstance(one, Poses) or one.tau is None:
                data.append(one)
            else:
                data.append(replace(one, tau=one.tau[:, list(reading.torque_order)] * reading.torques))
        groups[k] = replace(groups[k], data=tuple(data))
    return replace(problem, groups=tuple(groups))


def _residuals(problem: Problem, parts: Sequence[int], values: FloatArray) -> FloatArray:
    """RMS residual of each row of some groups."""
    each = [(problem.groups[k].by_kind, values[problem.places[k]]) for k in parts]
    return np.array([rms_residual(row, own) for by_kind, own in each for row in zip(*by_kind, strict=True)])
