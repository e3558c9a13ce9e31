"""The fit of a leg that stands: how its feet stand, which samples are wrong, and what sensors are off by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray
from exoid.errors import ExoidError, NotIdentifiableError
from exoid.estimate.finding import Finding, Severity
from exoid.leg.link_frames import link_frame
from exoid.leg.reduction.planar import GRAVITY
from exoid.signals import Recording
from exoid.signals.base_checks import flies
from exoid.signals.cutoff import noisier_base
from exoid.torques.contacts.imu import ROCKS, CorrectedBase, ImuErrors
from exoid.torques.contacts.standing_base import LEVEL, StandingBase
from exoid.torques.contacts.stretches import EDGE, SHORTEST
from exoid.torques.contacts.support_model import SupportModel

from .estimators import Estimator, huber
from .estimators.by_name import fit_linear
from .footing import LEAN, PIVOT, Footing, find_footing, tilted
from .ground_faults import joint_faults, moving_points, unlike_logs
from .problem import Fitted, Problem
from .row_changes import contact_offsets, residual, rms_residuals
from .support_groups import MEASURED, MUCH_LEFT_OUT, rocking_finding, support_groups

MOST = 400  # blocks of rows from which on knots of a lean would take minutes: ten minutes of stance
ROUNDS = 5  # most rounds in which masses, leans and pivots follow each other


def fit_on_ground(problem: Problem, estimator: Estimator, *, by_noise: bool, check: bool) -> Fitted:
    """Fit a model to recordings with contacts: once by rows that no outlier moves, and once without the outliers."""
    # Without a measured base, the compliance of soles and the lean of the ground are found, too. With a sensor whose
    # bias feet told, the lean is; with another sensor, its bias. Then outliers are looked for once more.
    problem = support_groups(problem, estimator, by_noise=by_noise, check=check)
    try:
        problem = without_outliers(fit_linear(problem, huber))
    except ExoidError as error:
        more = "let each foot stand while the other moves, and squat, shift and pitch on both"
        error.remedy = f"{error.remedy}; {more}"
        raise
    fitted = fit_linear(problem, estimator)
    if (footing := find_footing(fitted)) is not None:
        problem = without_outliers(fit_linear(tilted(problem, footing), huber))
        fitted = fit_linear(problem, estimator)
        for _ in range(ROUNDS):
            # What a lean does depends on masses and weights, which fits before had wrong by as much as the ground leans
            before, footing = footing, find_footing(fitted, footing) or footing
            fitted = fit_linear(tilted(fitted.problem, footing, before), estimator)
            if (np.abs(footing.found.values - before.found.values) <= np.sqrt(np.diag(footing.found.covariance))).all():
                break
    # a zero of an angle that is off may look like another scale of a log: joints come first
    looks = (moving_points(fitted), joint_faults(fitted, footing), unlike_logs(fitted, scaled=True))
    faults = next(filter(None, map(tuple, looks)), ()) if check else ()
    if footing is not None:
        if not faults:  # a foot that leans otherwise at each time would explain them, too, with many numbers
            fitted, footing = _rocking(fitted, footing, estimator)
        slopes = footing.found.slopes
        doubt = slopes @ footing.found.spread @ slopes.T
        fitted = fitted._replace(findings=tuple(_footing_findings(footing, fitted)), doubt=doubt)
    offsets = contact_offsets(fitted) if check else ()
    findings = (*faults, *fitted.findings, *_told_findings(fitted), *_gravity_findings(fitted), *offsets)
    return _suspended(fitted._replace(findings=findings), estimator)


def _rocking(fitted: Fitted, footing: Footing, estimator: Estimator) -> tuple[Fitted, Footing]:
    """Find how feet rock that carry a base, where their lean is not the same in all blocks of time."""
    least = ROCKS / GRAVITY
    known, level = footing.rocks, (fitted, footing)
    if not footing.links or known < 0.4 * least or footing.found.blocks > MOST:
        return level
    for turn in range(ROUNDS):
        before, footing = footing, find_footing(fitted, footing, rocking=True) or footing
        fitted = fit_linear(tilted(fitted.problem, footing, before), estimator)
        if footing.rocks < least:
            return level
        if turn > 1 and abs(footing.rocks - known) < 0.02 * known:  # pivots are not before the second
            break
        known = footing.rocks
    return fitted, footing


def _suspended(fitted: Fitted, estimator: Estimator) -> Fitted:
    """Allow for the noise of the base's sensor in flight and on a hook, where no foot pushes on the ground."""
    # Rows of a base that is free have no measured side, so that noise of their columns shrinks the parameters: beside
    # 0.1 m/s² that limbs push in flight, 0.02 m/s² count. The same noise once more moves them by about as much again.
    rng, groups, found = np.random.default_rng(0), [], []
    for group in fitted.problem.groups:
        data, leg = group.motions, group.model.leg
        links = group.model.links if isinstance(group.model, SupportModel) else ()
        hangs = links and all(link_frame(leg.model, leg.description, link).body < 0 for link in links)
        hangs = hangs and leg.description.root_link not in links
        for k, one in enumerate(data):
            if not leg.base_rows or one.base is None or one.base.pose is not None:
                continue
            if not hangs and (links or not flies(one.base.specific_force[one.mask])):
                continue
            data[k] = replace(one, base=noisier_base(one.base, rng))
            found.append(float(np.sqrt(np.mean(one.base.specific_force[one.mask] ** 2))))
        groups.append(replace(group, data=tuple(data)))
    if not found:
        return fitted
    problem, values = fitted.problem, fitted.fit.solution.values
    moved = fit_linear(replace(problem, groups=tuple(groups)), estimator).fit.solution.values - values
    std = np.sqrt(np.diag(fitted.fit.solution.covariance))
    most = int(np.argmax(np.abs(moved) / np.where(std > 0.0, std, np.inf)))
    what = f"parameters, {problem.names[most]} by about {abs(moved[most]):.2g}; this is part of all intervals"
    why = "no foot pushes on the ground: joint torques alone give the scale, and noise of the base's sensor moves"
    remedy, names = "weigh the machine (known=), or let a foot push on the ground", (problem.names[most],)
    finding = Finding("suspended", "", float(np.mean(found)), "m/s²", "info", f"{why} {what}", remedy, parameters=names)
    doubt = np.outer(moved, moved) + (0.0 if fitted.doubt is None else fitted.doubt)
    return fitted._replace(findings=(*fitted.findings, finding), doubt=doubt)


def _told_findings(fitted: Fitted) -> Iterator[Finding]:
    """Say what feet told of the errors of sensors."""
    bases = [(one.file_name, one.base) for one in fitted.problem.motions if isinstance(one.base, CorrectedBase)]
    # stretches of a recording share what was told; names of recordings may be alike
    for name, base in {(name, id(base.told), base.own): (name, base) for name, base in bases}.values():
        when = "while a foot rested" if base.own else "by another recording of the session"
        yield _imu_finding(base.told._replace(force_bias=base.bias), when, name, fitted.models[0].leg.parameter_names)


def _gravity_findings(fitted: Fitted) -> Iterator[Finding]:
    """Say whose accelerometer does not read gravity in the mean, after what was found of its bias was taken out."""
    for one in {one.q.tobytes(): one for one in fitted.problem.motions}.values():  # stretches of a recording share it
        base, width = one.base, round(one.sample_rate)
        if base is None or base.pose is not None or isinstance(base, StandingBase) or flies(base.specific_force):
            continue
        # Means of 1 s turn with the base, and leave quick pushes out; over 10 s a gain of 1 m/s is 1 % of gravity. Of
        # healthy logs, walkers (seeds 0 to 12) had 0.9998 to 1.001, walks whose bias only the rows tell 0.99 to 1.008.
        means = scipy.ndimage.uniform_filter1d(base.specific_force, width, axis=0)[width // 2 : -width // 2]
        scale = float(np.linalg.norm(means, axis=1).mean()) / GRAVITY if len(one) > 10 * width else 1.0
        if abs(scale - 1.0) > 0.02:
            text = f"less its bias, the accelerometer of the base reads {scale:.3g} times gravity in the mean"
            remedy = "calibrate it: divide its readings by that, or take a bias out that feet do not tell"
            yield Finding("imu-scale", "", scale, "1", "error", text, remedy, recording=one.file_name)


def _imu_finding(errors: ImuErrors, when: str, name: str, parameters: tuple[str, ...]) -> Finding:
    """Say what was taken out of the readings of an inertial measurement unit."""
    pairs = zip((errors.gyro_bias, errors.force_bias), np.split(errors.std, 2), strict=True)
    gyro, force = (f"({', '.join(f'{x:.2g}' for x in bias)}) ± {2.0 * each.max():.2g}" for bias, each in pairs)
    size, std = float(np.linalg.norm(errors.force_bias)), float(np.linalg.norm(errors.std[3:]))
    if errors.std[3:].max() > 0.05:  # [m/s²]: it leaves 0.5 % of gravity, and of every mass moment, open
        text = f"{when}, the bias of the base's sensor is known to ± {2.0 * std:.2g} m/s², as all intervals say"
        remedy = "stand still on both feet at the beginning, or calibrate it (base=replace(base, calibrated=True))"
        return Finding("imu-unchecked", "", 2.0 * std, "m/s²", "warning", text, remedy, None, parameters, name)
    # Accelerometers are off by less [m/s²]: more is a tilt by 3° of their mounting, or of the sole
    large, interval = size > 0.5, (size - 2.0 * std, size + 2.0 * std)
    more = "; no sensor is off by so much" if large else ""
    text = f"{when}, the base's sensor was off by {force} m/s² and {gyro} rad/s, which was taken out{more}"
    if not large:
        return Finding("imu-bias", "", size, "m/s²", "info", text, "calibrate the sensor", interval, (), name)
    remedy = "check its mounting and unit, the zeros of the joints, and that the sole is level at zero angles"
    return Finding("imu-bias", "", size, "m/s²", "warning", text, remedy, interval, parameters, name)


def without_outliers(fitted: Fitted) -> Problem:
    """Leave samples out whose residuals no noise explains: contacts that are labelled wrongly, or slip."""
    problem, findings = fitted.problem, dict[str, list[Finding]]()
    wrong = [_wrong_samples(fitted, k) for k in range(len(problem.groups))]
    counts = [(np.count_nonzero(mask), np.count_nonzero(bad)) for of_group in wrong for _, mask, bad, _ in of_group]
    total, lost = np.sum(counts, axis=0)
    if not lost:
        return problem
    # Where more than this part of the samples is so far off, the model is wrong rather than the contacts
    too_many = bool(lost > 0.3 * total)
    left = []
    for group, of_group in zip(problem.groups, wrong, strict=True):
        told, kept = findings.setdefault(group.name, []), []
        told += group.findings
        for one, mask, bad, row in of_group:
            if bad.any():
                share = float(np.count_nonzero(bad)) / np.count_nonzero(mask)
                told.append(_outlier(group.links or "", share, one, row, kept=too_many))
            rest = mask & ~bad
            if too_many or np.count_nonzero(rest) > SHORTEST * one.sample_rate:
                kept.append(one if too_many else replace(one, mask=rest))
        if kept:
            left.append(replace(group, data=tuple(kept)))
    groups = [replace(group, findings=tuple(findings.pop(group.name, ()))) for group in left]
    if findings:
        raise NotIdentifiableError("no sample of a leg on the ground fits the others", remedy="check the contacts")
    return replace(problem, groups=tuple(groups))


def _footing_findings(footing: Footing, fitted: Fitted) -> Iterator[Finding]:
    """Say how soft soles are, how the ground leans, what a lean would move, and how far a sensor was off."""
    halves = 2.0 * np.sqrt(np.diag(footing.found.spread))
    remedy = "record an IMU on the torso, which needs no such assumption"
    for (link, c), half in zip(footing.compliance.items(), halves.tolist(), strict=False):
        text = f"{link} tilts by {c:.2g} ± {half:.2g} rad/(N·m) under the torque of its joint, which intervals include"
        yield Finding("sole-compliance", "", c, "rad/(N·m)", "info", text, remedy, (c - half, c + half))
    names = fitted.models[0].leg.parameter_names
    if footing.knots:
        places = np.hstack([[*footing.pivots.values()] * np.array([1, -1]), halves[footing.part(PIVOT)].reshape(-1, 2)])
        text = "{} about a place {:.0f} ± {:.0f} mm before and {:.0f} ± {:.0f} mm below its origin"
        each = zip(footing.links, (1e3 * places[:, [0, 2, 1, 3]]).tolist(), strict=True)
        then = "; ".join(text.format(link, *place) for link, place in each)
        then += ". How they lean at each time follows from the torques, and its error is part of all intervals"
        yield rocking_finding(footing.rocks, then, "", names)
    elif footing.links and footing.found.blocks > MOST and footing.rocks > ROCKS / GRAVITY:
        then = "logs are too long to find how they lean at each time, and no interval holds it: pass some minutes"
        yield replace(rocking_finding(footing.rocks, then, "", names), severity="error")
    if len(footing.sensor):
        when = "as no foot rests flat and still for a second in any recording, or feet rock, by all rows"
        yield _imu_finding(footing.imu, when, "", names)
    angle, half = (float(np.rad2deg(np.linalg.norm(x))) for x in (footing.lean, halves[footing.part(LEAN)]))
    if footing.links or angle > 2.0 * half:
        yield _lean_finding(footing, fitted, angle, half)


def _lean_finding(footing: Footing, fitted: Fitted, angle: float, half: float) -> Finding:
    """Say by how much the ground leans [deg], and what one degree would move."""
    model = fitted.models[0]  # first the parameters that it moves by most of their standard deviations
    places = fitted.problem.places[0][: len(model.names)]
    moves = np.deg2rad(1.0) * np.linalg.norm(footing.found.slopes[places, footing.part(LEAN)], axis=1)
    std = np.sqrt(np.diag(fitted.fit.solution.covariance))[places]
    most = np.argsort(-moves / np.where(std > 0.0, std, np.inf))[:3]
    moved = ", ".join(f"{model.names[k]} by {moves[k]:.2g} {model.units[k]}" for k in most)
    what, remedy = "the motion of the base was not measured, and", "record an IMU on the torso"
    if not footing.links:
        what, remedy = "the bias of the base's sensor", "calibrate the sensor"
    lean = f"{angle:.2g} ± {half:.2g}°, which was taken into account; one degree would move {moved}"
    text = f"{what} follows from feet that rest. The ground under them leans by {lean}"
    remedy = f"level the ground, or check the zeros of the angles; {remedy}"
    # floors are level to half a degree: one that leans by more is a treadmill, a ramp, or a wrong zero of an angle
    severity: Severity = "warning" if angle - half > np.rad2deg(2.0 * LEVEL) else "info"
    return Finding("base-from-feet", "", angle, "°", severity, text, remedy, (angle - half, angle + half))


def _wrong_samples(fitted: Fitted, index: int) -> list[tuple[Recording, BoolArray, BoolArray, str]]:
    """Recordings of a group, samples that count, those near residuals that no noise explains, and the row of most."""
    problem, group, values, found = fitted.problem, fitted.problem.groups[index], fitted.values(index), []
    residuals = [(rows.time, residual(rows, values)) for rows in map(group.decimated, range(len(group.data)))]
    sizes = [np.abs(row[row != 0.0]) for row in np.vstack([left for _, left in residuals]).T]
    # by the median, which outliers do not move, or by up to twice as much where noise is not the same at all times; not
    # for feet that carry the base: slips look alike. Errors of filters are 0.3 % of the torque of the row
    quantiles = np.array([np.quantile(x, (0.5, 0.9)) if len(x) else (np.inf, np.inf) for x in sizes])
    middle, most = quantiles.T / [[0.6745], [1.6449]]  # those of normal noise
    stands = any(isinstance(one.base, StandingBase) for one in group.motions)
    middle = middle if stands else np.clip(most, middle, 2.0 * middle)
    scale = np.maximum(middle, 0.003 * rms_residuals(problem, [index], np.zeros(len(problem.names))))
    for one, (time, left) in zip(group.motions, residuals, strict=True):
        assert one.mask is not None  # see `split`
        far, large = np.zeros(len(one), dtype=np.bool_), np.abs(left) > 6.0 * scale
        far[np.searchsorted(one.time, time[large.any(axis=1)])] = True
        near = scipy.ndimage.binary_dilation(far, iterations=round(EDGE * one.sample_rate))
        found.append((one, one.mask, one.mask & near, group.model.row_names[int(large.sum(axis=0).argmax())]))
    return found


def _outlier(support: str, share: float, recording: Recording, row: str, *, kept: bool) -> Finding:
    """Say that samples do not fit."""
    severity: Severity = "warning" if kept or share > MUCH_LEFT_OUT else "info"
    kind, cause = "wrong-contact", "a contact is labelled wrongly, slips, or another force acts"
    remedy, where = "check friction terms, contacts and other forces on the leg", recording.file_name
    if support == MEASURED:  # with a load cell alone no contact can be labelled wrongly: the model may be poor
        kind, cause, support = "large-residual", "friction has another form, or another force acts", "measured forces"
    elif kept:
        severity = "error"
    fate = "they are too many to leave out" if kept else "they were left out"
    driven = {*recording.joint_names} - {*recording.passive} if kind == "large-residual" else ()
    joint = row if row in driven else ""
    text = f"{share:.1%} of the samples with {support} do not fit the others{f', most at {joint}' * bool(joint)}: "
    return Finding(kind, joint, share, "1", severity, f"{text}{cause}; {fate}", remedy, recording=where)
