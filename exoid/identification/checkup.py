"""Checks of the logs of a fit: faults that would otherwise pass in silence, and delays that are taken out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.actuators.constants import DriveConstant
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding, Severity
from exoid.regression.least_squares import factorize_rows, rms_residual
from exoid.signals import Poses, Recording, Recordings, without_torque_delay
from exoid.signals.cutoff import noisier, noisier_base

from .estimators import Estimator
from .estimators.by_name import fit_linear
from .findings.arms import arm_shapes
from .findings.channels import quantum
from .findings.sample import FittedLeg, few_of
from .findings.score import HALF_WIDTH, in_half_widths
from .findings.search import find_faults
from .group_rows import Group
from .problem import Fitted, Problem
from .row_changes import OTHER_LOG, change_recordings, torque_delays


def fitted_leg(fitted: Fitted, group: int, covariance: FloatArray) -> FittedLeg:
    """Gather what a check of one group needs."""
    model, problem, rows = fitted.models[group], fitted.problem, fitted.problem.groups[group]
    place = problem.layout.groups.index(rows.name)
    names = problem.layout.names_of(place)
    knowledge = problem.layout.known_by(place, problem.prior_knowledge)
    # a coefficient that is known to be zero was left out
    told = {name: (value, 0.0) for name, value in knowledge.known.items() if value} | dict(knowledge.prior.values)
    held = {names[problem.names[k]]: 0.0 for k in fitted.fit.solution.bounded if problem.names[k] in names}
    fixed = np.array([{**knowledge.known, **held}.get(name, np.nan) for name in model.names])
    arms = {} if rows.actuators is None else arm_shapes(rows.actuators, model.leg)
    constants: tuple[DriveConstant, ...] = getattr(rows.model, "constants", ())
    scales = {each.name: each.joint for each in constants if each.constant.is_scale}
    assert rows.preparation is not None
    return FittedLeg(model, rows.data, rows.preparation, fixed, fitted.values(group), covariance, arms, told, scales)


def logs_apart(group: Group, values: FloatArray) -> Iterator[Finding]:
    """Find logs that the fit explains far worse than the others. Finer checks see a few of many."""
    moving = [k for k in range(len(group.data)) if not group.at_rest(k)]
    if len(moving) < 3:  # of two, either may be the one that is wrong
        return
    every = [factorize_rows(group.decimated(k)) for k in moving]
    # over the torque of the log and that of all: where one bends the fit, fast logs have larger residuals, too
    left, own = (np.array([[rms_residual([row], x) for row in log] for log in every]) for x in (values, 0.0 * values))
    whole = np.hypot(own, [rms_residual(of_row, 0.0 * values) for of_row in zip(*every, strict=True)])
    share = left / np.where(whole > 0.0, whole, np.inf)  # none of a passive joint
    usual = np.median(share, axis=0)
    bound = np.maximum(0.01, 4.0 * usual)  # of 30 logs without a fault beside one of any kind, at most half of it
    for k, of_log, j in zip(moving, share, np.argmax(share / bound, axis=1), strict=True):
        if of_log[j] > bound[j]:
            name, joint = group.data[k].file_name or f"recording {k + 1}", group.model.row_names[j]
            text = f"{of_log[j]:.1%} of the torque is unexplained in {name}, and {usual[j]:.1%} in half of the logs"
            yield Finding("large-residual", joint, float(of_log[j]), "1", "warning", text, OTHER_LOG, recording=name)


def with_noise_checked(fitted: Fitted, estimator: Estimator) -> Fitted:
    """Name parameters that noise of the angles shrinks, of which a cut-off that was passed may leave too much."""
    # Noise in columns shrinks parameters (errors in variables), most where columns nearly cancel each other, and the
    # same noise once more does so by about as much again. Its random part is odd, and cancels between both signs.
    problem, solution = fitted.problem, fitted.fit.solution
    if all(isinstance(one, Poses) or one.a is not None for group in problem.groups for one in few_of(group.data)):
        return fitted
    try:
        # of many recordings on disk a few remain, whose solution without more noise is not that of all
        problems = (change_recordings(problem, partial(_noisier, np.random.default_rng(0), x)) for x in (1, -1, 0))
        *noisy, same = (fit_linear(each, estimator).fit.solution.values for each in problems)
    except ExoidError:
        return fitted
    half = 2.0 * np.sqrt(np.diag(solution.covariance))
    moves = in_half_widths(np.mean(noisy, axis=0) - same, half)
    # Half a half width: 95 % intervals then hold in 83 %; at two of them in 3 %
    names = tuple(problem.names[k] for k in np.argsort(-moves) if moves[k] > 0.5)
    if not names:
        return fitted
    most = float(moves.max())
    shown = f"{', '.join(names[:3])}{' and others' if len(names) > 3 else ''}"
    message = f"noise of the angles, which no interval includes, moves {shown} by up to {most:.2g} half widths"
    remedy = "leave cutoff and preparation out, so that the noise chooses, or use the estimator ml"
    severity: Severity = "error" if most > 2.0 else "warning"
    finding = Finding("noisy-angles", "", most, "1", severity, message, remedy, parameters=names)
    return fitted._replace(findings=(*fitted.findings, finding))


def _noisier(rng: np.random.Generator, sign: float, _: Group, one: Recording) -> Recording:
    """Add noise of its own size to a motion whose accelerations are derived, of one sign or the other."""
    if one.a is not None:
        return one
    q = noisier(one.q, rng, sign)
    base = one.base if one.base is None or one.base.pose is not None else noisier_base(one.base, rng, sign)
    return replace(one, q=q, base=base)


def rounding_errors(
    fitted: Fitted, estimator: Estimator, covariance: FloatArray
) -> tuple[FloatArray, tuple[Finding, ...]]:
    """Covariance that rounding of the angles adds where it is the same in each stride, and the finding that says so."""
    # Such errors move parameters as one stride would, and no residual shows it: those of counts that begin elsewhere
    # tell their size. Four of them have a t distribution whose quantile is √2 times the normal one.
    problem, none = fitted.problem, np.zeros_like(covariance)
    every = (one for group in problem.groups if not isinstance(group.data, Recordings) for one in group.data)
    if not any(isinstance(one, Recording) and one.a is None and rounding_repeats(one.q) for one in every):
        return none, ()
    try:
        shifted = (change_recordings(problem, partial(_rounded_again, x)) for x in (0.2, 0.4, 0.6, 0.8))
        same = change_recordings(problem, lambda _, one: one, torques=True)
        fits = [fit_linear(each, estimator) for each in (same, *shifted)]
    except ExoidError:
        return none, ()
    values = np.array([one.fit.solution.values for one in fits])
    changes = values[1:] - values[0]
    doubt = 2.0 / len(changes) * changes.T @ changes
    grown = np.sqrt(1.0 + np.diag(doubt) / np.maximum(np.diag(covariance), np.finfo(float).tiny))
    names = tuple(problem.names[k] for k in np.argsort(-grown) if grown[k] > 1.25)
    if doubt.shape != covariance.shape or not names:
        return none, ()
    most = float(grown.max())
    message = f"the angles are rounded alike in each stride: intervals are up to {most:.2g} times as wide by that"
    remedy = "move in a way that does not repeat to the sample and the count of an encoder, or use finer encoders"
    return doubt, (Finding("noisy-angles", "", most, "1", "info", message, remedy, parameters=names),)


def rounding_repeats(q: FloatArray) -> bool:
    """Whether encoders round a motion that repeats in the same way each time, by at most 20 000 samples."""
    # Eighth differences leave of a slow motion its rounding, of variance (16 over 8) / 12 counts². From 20 samples on
    # white noise is no longer like itself; sums of fewer products are smaller. What is 0.3 to 2 times as large as
    # rounding is rounding, and repeats where a later stretch is more than half alike.
    q = q[:20_000]
    rough, half = np.diff(q, 8, axis=0), len(q) // 2
    if half <= 20:
        return False
    size = np.sqrt(12.0 / 12870.0 * np.mean(rough**2, axis=0)) / [max(quantum(x), 1e-7) for x in q.T]
    rounded = rough.T[(size > 0.3) & (size < 2.0)]
    power = np.abs(scipy.fft.rfft(rounded, 2 * len(rough))) ** 2
    alike = scipy.fft.irfft(power)[:, 20:half] / np.linspace(1.0, 0.5, half)[20:]
    return bool((alike.max(axis=1, initial=0.0) > 0.5 * np.sum(rounded**2, axis=1)).any())


def _rounded_again(shift: float, group: Group, one: Recording) -> Recording:
    """Add the rounding of counts that begin elsewhere, where accelerations are derived."""
    if one.a is not None:
        return one
    assert group.preparation is not None
    count = np.array([max(quantum(x), 1e-9) for x in one.q.T])
    smooth = group.preparation.filter(one.q, one.sample_rate) / count + shift
    return replace(one, q=one.q + count * (np.round(smooth) - smooth))


def without_delays(problem: Problem, fitted: Fitted) -> Problem:
    """Estimate by how much torques are late, shift them, and say so: of every group of the problem that was fitted."""
    groups = []
    for group in problem.groups:
        parts, names = fitted.problem.parts(group.name), group.model.leg.joint_names
        if fitted.problem.groups[parts[0]].links is None:
            leg, (late, half) = fitted_leg(fitted, parts[0], fitted.fit.solution.covariance), np.zeros((2, len(names)))
            faults, _ = find_faults(leg._replace(data=few_of(leg.data)).sampled())
            for score in (one.score for one in faults if one.score.nuisance.kind == "torque-delay"):
                joint = slice(None) if score.nuisance.place < 0 else score.nuisance.place  # those of all, and of one
                late[joint] += score.delta[0]
                half[joint] = np.hypot(half[joint], HALF_WIDTH * score.std[0])
        else:
            late, half = torque_delays(fitted, parts)
        by_joint, found = {k: float(late[k]) for k in np.flatnonzero(late).tolist()}, list(group.findings)
        for k, delay in by_joint.items():
            when = f"{1e3 * abs(delay):.3g} ms {'after' if delay > 0.0 else 'before'} the motion"
            message = f"the torque of {names[k]} came {when}, and was shifted by that"
            remedy = "correct the time stamps of the log; validation shifts its torques by the same"
            interval = (delay - float(half[k]), delay + float(half[k]))
            found.append(Finding("torque-delay", names[k], delay, "s", "info", message, remedy, interval))
        chosen = (group.model.select(one) for one in group.data if by_joint)
        data = [one if isinstance(one, Poses) else without_torque_delay(one, by_joint) for one in chosen]
        shifted = replace(group, data=data, delays=late, findings=tuple(found))
        groups.append(shifted if by_joint else group)  # without delays, logs on disk stay there
    return replace(problem, groups=tuple(groups))
