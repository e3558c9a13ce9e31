"""Which links rest on the ground at each sample, and what is left of a recording while they do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import compress
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import NotIdentifiableError, UnreadableInputError
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.signals import Preparation, Recording, Wrench, ZeroPhase
from exoid.signals.contacts import LEAST_LOAD, LIFT, contacts_from_wrench
from exoid.signals.filters.low_pass import slow_part
from exoid.signals.link_wrenches import wrenches_on_links

from .elimination import Elimination, eliminate
from .imu import CorrectedBase, ImuErrors, imu_errors, late, refuse_turned, turns_on_feet
from .kinds import foot_of, on_time, refuse_overdetermined, touch_downs, whole_feet
from .sliding import LOOK, Slip, sliding, slipping
from .standing_base import level_rotation, standing_base, standing_reading

EDGE = 0.1
"""Feet say how a base moves that was not measured, where this far from a touch-down or lift-off [s].

Shorter gaps of a contact are filled.
"""

SHORTEST = 0.15
"""Supports that last less than this in a recording [s] are left out."""


class Left(NamedTuple):
    """Samples of a recording that were left out, as shares of those that could count."""

    changing: float  # near a touch-down; where feet say how the base moves, also near a lift-off
    slipping: float  # A link that was said to rest moved, and the motion of the base had to follow from it
    singular: float  # chains were closed and stretched, or left no row
    floating: float  # no foot rested flat, and the motion of the base had to follow from one
    # not left out: gaps of a contact that are shorter than the edge, which were filled. Nothing becomes wrong
    # when the wrench of a link that bears no load is eliminated
    gaps: float
    # not left out: a link that was said to rest moved, but the motion of the base was measured. Its wrench is
    # eliminated, or measured, whether it rests or not
    moving: float


class Stretch(NamedTuple):
    """Part of a recording in which the same links rest by unknown wrenches."""

    links: tuple[str, ...]  # these links; the root link for a base that is held; none where no wrench is unknown
    plates: tuple[str, ...]  # where none is unknown: feet under a floating base that rest by measured wrenches
    recording: Recording  # the recording with a mask of the samples, and with the motion of the base


class Split(NamedTuple):
    """A recording, split by the links that rest."""

    stretches: tuple[Stretch, ...]  # one for each set of links that rest by unknown wrenches
    left: Left  # samples that were left out
    imu: ImuErrors | None  # errors of the IMU that this recording tells, or how its feet rock; None without rest
    visible: float  # slowest slip of all feet alike that the motion of the base shows [m/s]; zero where it shows none
    near: float  # time around a touch-down that was left out [s]
    late: Mapping[str, float]  # time by which the switches of a foot closed too late [s]; contacts begin earlier by it
    turns: FloatArray  # what turns on flat feet say of the base's sensor, (6, 6), see :func:`~.imu.turns_on_feet`
    delay: float  # time by which this sensor reads later than the angles [s], which was taken out; negative for earlier


def split(
    leg: Leg,
    recording: Recording,
    preparation: Preparation | None = None,
    session: ImuErrors | None = None,
    *,
    tell: bool = True,
) -> Split:
    """Split a recording by the links that rest with an unknown wrench, and take errors of its IMU out."""
    recording = recording.resampled()  # those of the session where it tells none, as feet rock
    recording = replace(recording, wrenches=wrenches_on_links(leg, recording))
    recording, gaps = _without_gaps(recording)
    recording, closed_late = on_time(leg, recording)
    rest, unknown = _contacts(leg, recording)
    counted = np.ones(len(recording), dtype=np.bool_) if recording.mask is None else recording.mask
    # so many samples before and after each touch-down and lift-off; the ends of a log are none
    changes = np.any([np.diff(flags, prepend=flags[:1]) for flags in rest.values()], axis=0)
    edge, around = (round(share * EDGE * recording.sample_rate) for share in (1.0, 0.5))
    lasting = np.convolve(np.broadcast_to(changes, len(recording)), np.ones(2 * edge))[edge:][: len(recording)] < 0.5
    # A touch-down is a jolt, which the low-pass of the angles smears over so many samples on either side: both sides of
    # the equation differ there. For 0.03 s more the foot slips and rings; 0.02 s are too few, see
    # scripts/study_heel_toe.py. At a lift-off nothing jumps. The force of a foot counts as unknown for 0.05 s longer
    # than its contact: a force that is zero may be eliminated, too, and a switch may be late.
    smeared = max(1, (preparation or ZeroPhase()).kinematics(recording).valid.start)
    ringing, near = round(0.03 * recording.sample_rate), smeared / recording.sample_rate + 0.03
    steady = ~scipy.ndimage.binary_dilation(touch_downs(leg, rest, len(recording), ringing), None, smeared)
    beside = smeared + round(0.05 * recording.sample_rate)
    longer = {link: scipy.ndimage.binary_dilation(x, iterations=beside) for link, x in (unknown | rest).items()}
    down = whole_feet(leg, longer)
    if leg.base_rows and recording.base is None:
        steady, near, down = lasting, EDGE, unknown | rest
    slow = slow_part(recording.q, recording.sample_rate, LOOK)
    still = ~slipping(leg, rest, slow, recording.time, around) if recording.contacts else np.ones_like(counted)
    feet = {link: flags & lasting for link, flags in rest.items() if link != leg.description.root_link}
    # a foot on a point or an edge does not say how the base stands
    soles = {link: flags for link, flags in feet.items() if leg.contact_kind(link) == "flat"}
    recording, imu, slip, turns, delay = _without_bias(leg, recording, soles, session, tell=tell)
    found, lost, floating = [], *np.zeros((2, len(recording)), dtype=np.bool_)
    moving, usual = ~still | slip.slides, steady if recording.base is not None else steady & still
    plates = [link for link in feet if link in recording.wrenches and leg.base_rows]
    flags = np.column_stack([counted, *(down[link] for link in (*unknown, *plates))])
    patterns, which = np.unique(flags, axis=0, return_inverse=True)
    for k, pattern in enumerate(patterns):
        together, where = tuple(compress((*unknown, *plates), pattern[1:])), which.ravel() == k
        links = tuple(link for link in together if link in unknown)
        inside = counted & usual & where
        usable = inside.copy()
        if links and inside.any():  # a closed chain that leaves no row, or a stretched one
            rows = eliminate(leg, links, slow[inside])
            usable[inside] = rows.fit & (rows.loop is None or rows.loop.shape[2] > 0)
            _refuse_held_rail(leg, recording, links, rows)
        lost |= inside & ~usable
        if np.count_nonzero(usable) >= SHORTEST * recording.sample_rate:
            flat = [link for link in soles if rest[link][usable].all()]
            stretch = _stretch(leg, recording, links, flat, set(plates) - set(together), usable)
            if stretch is None:
                floating |= usable
            else:
                found.append(stretch if links else stretch._replace(plates=together))
    if not found and floating.any():
        raise UnreadableInputError(
            "the base moves, and no motion of it was recorded while no link rests flat on the ground",
            where=recording.file_name,
            remedy="record it (base=exoid.BaseMotion.from_imu(...), columns base_gyro_x…z and base_acc_x…z), or say "
            f"when feet are flat on the ground (contacts=){_unchanging(recording)}",
        )
    if not found:
        raise NotIdentifiableError(
            "no sample is left of contacts that last, do not slip and leave a row of the equation",
            where=recording.file_name,
            remedy=f"check the contacts{_unchanging(recording)}; record longer stance, or measure the wrenches",
        )
    parts = (counted & ~steady, counted & steady & ~usual, lost, floating, counted & gaps, counted & usual & moving)
    left_out = Left(*(float(np.count_nonzero(part)) / max(1, int(np.count_nonzero(counted))) for part in parts))
    return Split(tuple(found), left_out, imu, slip.visible, near, closed_late, turns, delay)


def _stretch(
    leg: Leg, recording: Recording, links: tuple[str, ...], flat: Sequence[str], unloaded: set[str], usable: BoolArray
) -> Stretch | None:
    """Samples at which the same links rest; None if nothing says how the base moves."""
    # The plate under a foot in the air reads noise, which is left out of the rows; a load says that it is not.
    wrenches = dict(recording.wrenches)
    for link in unloaded:
        if np.linalg.norm(wrenches[link].force[usable].mean(axis=0)) < LEAST_LOAD:
            del wrenches[link]
    base = recording.base
    if base is None and leg.base_rows and flat:
        base = standing_base(leg, recording, flat[0])
        mean = base.specific_force.mean(axis=0)
        if mean[2] < -0.5 * np.linalg.norm(mean):  # cosine of the mean lean
            what = f"by the angles of its joints, the base is upside down over {flat[0]}, which rests"
            remedy = "look for a sign, unit or order of angles that differs from the URDF's, such as of both knees"
            raise UnreadableInputError(what, where=recording.file_name, remedy=remedy)
    if base is None and leg.base_rows and leg.description.root_link not in links:
        return None
    if leg.base_rows and not links and base is not None:
        size = float(np.linalg.norm(base.specific_force[usable].mean(axis=0)))
        borne = sum(float(np.linalg.norm(wrench.force[usable].mean(axis=0))) for wrench in wrenches.values())
        # The first parameter is the mass of the machine, which a URDF has wrong by a factor, but not by ten
        if size > 0.5 * GRAVITY and borne < 0.1 * leg.parameters[0] * size:
            what = f"no contact is there, wrenches of {borne:.3g} N bear hardly any weight"
            what = f"{what}, and the accelerometer of the base reads {size:.3g} m/s²: it is held"
            remedy = "say what holds it: a foot, a hook or a stand by a contact of its link, a load cell by a wrench"
            remedy += _unchanging(recording) or " (is a switch inverted?)"
            raise UnreadableInputError(what, where=recording.file_name, remedy=remedy)
    return Stretch(links, (), replace(recording, mask=usable, base=base, wrenches=wrenches))


def _unchanging(recording: Recording) -> str:
    """Ask for switches that never change, as a dead one does."""
    same = [f"{x} reads {int(y[0])} at all samples" for x, y in recording.contacts.items() if y.all() or not y.any()]
    return f" (is a switch dead? that of {', of '.join(same)})" if same else ""


def _without_bias(
    leg: Leg, raw: Recording, soles: Mapping[str, BoolArray], session: ImuErrors | None, *, tell: bool
) -> tuple[Recording, ImuErrors | None, Slip, FloatArray, float]:
    """Take errors of the inertial measurement unit out that feet at rest tell; these, slips, its turns and delay."""
    base, slip, imu, rate = raw.base, Slip(np.zeros(len(raw), dtype=np.bool_), 0.0), None, raw.sample_rate
    if base is None or not leg.base_rows:
        return raw, imu, slip, np.zeros((6, 6)), 0.0
    still = {link: standing_reading(leg, raw, link, base.position) for link in soles}
    refuse_turned(leg, raw, still, soles)
    turns = turns_on_feet(leg, raw, still, soles)
    # a pose is as late as wrenches in axes of the laboratory, and stays; feet that rock turn a base as if it were late
    measured, known = base, 0.0 if session is None else session.delay
    for delay in (0.0,) if base.pose is not None else (late(turns), late(turns, rocks=True) or known):
        base = measured.interpolated(raw.time, np.clip(raw.time + delay, *raw.time[[0, -1]])) if delay else measured
        if (feet := imu_errors(base, still, soles, rate)) is not None and not feet.rocks:
            break
    turns = turns_on_feet(leg, replace(raw, base=base), still, soles) if delay else turns
    corrected = base
    for _ in range(2):  # what a foot that slides says of the sensor is left out the second time
        rests = {link: flags & ~slip.slides for link, flags in soles.items()}
        imu = imu_errors(base, still, rests, rate) if tell and not base.calibrated else None
        imu = None if imu is None else imu._replace(delay=delay)
        errors = session if imu is None or imu.rocks else imu
        if errors is not None and not base.calibrated:
            corrected = errors.corrected(base)
            if errors.gyro_bias.any() or errors.force_bias.any():  # on level ground: torques may say otherwise
                columns = corrected.angular_velocity, corrected.specific_force, base.position, base.pose
                corrected = CorrectedBase(*columns, told=errors, own=errors is imu, bias=errors.force_bias)
        slip = sliding(corrected, still, soles, rate) if raw.contacts else slip
        if not slip.slides.any():
            break
    return replace(raw, base=corrected), imu, slip, turns, delay


def _refuse_held_rail(leg: Leg, recording: Recording, links: tuple[str, ...], rows: Elimination) -> None:
    """Refuse contacts that hold all joints of a leg on a rail: in the air, its rows also fit where nothing has mass."""
    foot, rail = links[0], leg.joint_names[0]
    if rail in recording.passive and rows.loop is not None and not rows.loop.shape[2]:
        kind, where = leg.contact_kind(foot), recording.file_name
        what = f"the {kind} contact of {foot} holds all joints; nothing else tells what {rail} bears"
        remedy, command = (
            f"say that {foot} rests on a point, {how}, or measure its force"
            for how in (f'contacts={{"{foot}": "point"}}', f"--contact {foot}=point")
        )
        raise NotIdentifiableError(what, where=where, remedy=remedy, command=command, joints=(rail,))


def _without_gaps(recording: Recording) -> tuple[Recording, NDArray[np.bool_]]:
    """Fill gaps of contacts that are shorter than the edge; tell at which samples, (N,)."""
    around = round(EDGE * recording.sample_rate)
    inner, shape = slice(around + 1, -around - 1), np.ones(around + 1, dtype=np.bool_)
    gaps, filled = np.zeros(len(recording), dtype=np.bool_), {}
    for link, flags in recording.contacts.items():
        longer = np.pad(np.asarray(flags), around + 1)
        filled[link] = scipy.ndimage.binary_closing(longer, shape)[inner]
        gaps |= filled[link] & ~np.asarray(flags)
    return (replace(recording, contacts=filled) if gaps.any() else recording), gaps


def _contacts(leg: Leg, recording: Recording) -> tuple[dict[str, BoolArray], dict[str, BoolArray]]:
    """Find which links rest, and which of them by a wrench that was not measured."""
    refuse_overdetermined(leg, recording)
    links = (*recording.contacts, *recording.wrenches)
    rest = whole_feet(leg, {link: np.asarray(flags) for link, flags in recording.contacts.items()})
    for link, wrench in recording.wrenches.items():
        flags = contact_of(leg, link, wrench) if link not in rest and link != leg.description.root_link else None
        if flags is not None:
            rest[link] = flags
    unknown = {link: flags for link, flags in rest.items() if not {link, foot_of(leg, link)} & {*recording.wrenches}}
    # On a fixed base, links of other legs are part of the base: forces on them reach no row
    bent = np.full((1, len(leg.joint_names)), 0.1)
    unknown = {link: flags for link, flags in unknown.items() if np.abs(leg.contact_jacobian(bent, link)).any()}
    if not links and leg.base_rows:
        unknown[leg.description.root_link] = np.ones(len(recording), dtype=np.bool_)
    return rest, unknown


def contact_of(leg: Leg, link: str, wrench: Wrench) -> BoolArray | None:
    """Find contact of a link from its measured wrench."""
    up = level_rotation(leg, link).T @ (0.0, 0.0, 1.0)
    normal = wrench.force @ up
    low, high = np.quantile(normal, [0.02, 0.98])
    return contacts_from_wrench(wrench, up=up) if high > LEAST_LOAD and low < LIFT * high else None
