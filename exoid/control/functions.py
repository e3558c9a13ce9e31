"""Functions of an exoskeleton as data: contacts in order, trajectories scaled to the wearer, entry and exit.

Angles are flexion: hip forward, knee backward, ankle upward. A vector (forward, up) is the complex number x + i z.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, ComplexArray, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.experiments.gait import healthy_gait
from exoid.experiments.ground.walking import TILT_DEG
from exoid.leg.leg import Leg
from exoid.rig.ground import Sole
from exoid.tools.numbers import checked

SIDES = ("left", "right")
"""Sides in the order of all tables."""

SEAT = "seat"
"""Name of the contact of the torso with a chair."""

PHASE = np.linspace(0.0, 1.0, 201)
"""Phases at which trajectories are tabulated."""

DOWN = 0.004
"""Height of the lowest point of a sole below which a foot of a walk counts as on the ground [m]."""

ROOM = 0.5
"""Distance from the first or last posture within which a function may begin or end [rad], an assumption."""

STANDING = 0.97
"""Height of the hip while standing over the length of the straight leg."""

STAIR_TILT_DEG = {
    True: ((0.0, 0.6, 0.68, 0.8, 0.86, 0.95, 1.0), (0.0, 0.0, -12.0, -35.0, -30.0, -4.0, 0.0)),
    False: ((0.0, 0.3, 0.62, 0.75, 0.85, 0.95, 1.0), (0.0, 0.0, -30.0, -40.0, -25.0, 0.0, 0.0)),
}
"""Phases from a foot's own contact and angles of its sole on stairs [deg], up and down, by the range of the ankle."""

TURNS = np.array([1.0, -1.0, 1.0])
"""Signs of hip, knee and ankle about −lateral: the knee flexes backward."""

Contacts = frozenset[str]


@dataclass(frozen=True)
class Body:
    """Lengths of a wearer in the machine, from which trajectories are scaled.

    Attributes:
        thigh: Hip to knee [m].
        shank: Knee to ankle [m]; to the ground for a leg without ankle.
        ankle: Height of the ankle above the sole [m]; 0 for a leg without ankle.
        heel: Heel forward of the ankle, negative [m].
        toe: Toe forward of the ankle [m].
        seat: Height of the hip above the seat while seated [m], an assumption.

    Raises:
        ExoidError: A length is not positive, or the toe is not ahead of the heel.
    """

    thigh: float
    shank: float
    ankle: float = 0.0
    heel: float = -0.01
    toe: float = 0.01
    seat: float = 0.09

    def __post_init__(self) -> None:
        """Check the lengths."""
        checked([self.thigh, self.shank], "the lengths of a leg [m]", above=0.0, most=1.0)
        checked([self.ankle, self.seat, self.toe - self.heel], "the lengths of foot and seat [m]", least=0.0, most=0.5)

    @classmethod
    def of(cls, leg: Leg, soles: Mapping[str, Sole]) -> Body:
        """Read the lengths of the first limb of a planar machine.

        Args:
            leg: Planar machine with hip, knee and perhaps ankle.
            soles: Sole of each foot by the name of its link.

        Returns:
            The lengths.

        Raises:
            ExoidError: The machine is not planar, or its legs have other joints.
        """
        joints = [limb.chain.n for limb in leg.limbs]
        foot = next((sole for link, sole in soles.items() if link != leg.description.root_link), None)
        if not joints or joints[0] not in (2, 3) or foot is None:
            raise BadArgumentError(
                "no lengths of hip, knee and sole", where=leg.description.name, remedy="use a planar machine with soles"
            )
        offsets = np.linalg.norm(leg.limbs[0].chain.offsets, axis=1)
        forward, up = foot.points @ leg.plane.forward, float(foot.centre @ leg.plane.up)
        if joints[0] == 2:  # the sole is on the shank
            middle = float(forward.mean())
            return cls(float(offsets[0]), -up, 0.0, float(forward.min()) - middle, float(forward.max()) - middle)
        return cls(float(offsets[0]), float(offsets[1]), -up, float(forward.min()), float(forward.max()))

    @property
    def leg(self) -> float:
        """Length of the straight leg, sole to hip [m]."""
        return self.thigh + self.shank + self.ankle

    def reach(
        self, hip: ComplexArray, pitch: FloatArray | float, middle: ComplexArray, tilt: FloatArray | float
    ) -> FloatArray:
        """Find the flexion that puts the middle of a sole at a place (two links and a foot).

        Args:
            hip: Place of the hip [m], (K,).
            pitch: Pitch of the torso [rad]; negative leans forward, (K,) or a number.
            middle: Place of the middle of the sole [m], (K,).
            tilt: Angle of the sole to the horizontal, toe up [rad], (K,) or a number.

        Returns:
            Flexion of hip, knee and ankle [rad], (K, 3).

        Raises:
            ExoidError: The leg is too short.
        """
        turn = np.exp(1j * np.asarray(tilt))
        way = middle + turn * (1j * self.ankle - 0.5 * (self.heel + self.toe)) - hip
        a, b = self.thigh, self.shank
        cosine = (np.abs(way) ** 2 - a * a - b * b) / (2.0 * a * b)
        if not (np.abs(cosine) < 1.0).all():
            raise BadArgumentError(
                f"a foot is up to {np.abs(way).max():.3g} m from the hip, a leg of {a + b:.3g} m",
                remedy="take smaller steps, or a lower seat or riser",
            )
        knee = np.arccos(cosine)
        thigh = np.angle(1j * way) + np.arctan2(b * np.sin(knee), a + b * np.cos(knee))
        return np.column_stack([thigh - pitch, knee, tilt - (thigh - knee)])

    def sole(self, hip: ComplexArray, pitch: FloatArray | float, flexion: FloatArray) -> ComplexArray:
        """Locate heel and toe of a leg.

        Args:
            hip: Place of the hip [m], (K,).
            pitch: Pitch of the torso [rad], (K,) or a number.
            flexion: Flexion of hip, knee and ankle [rad], (K, 3).

        Returns:
            Places of heel and toe [m], (K, 2).
        """
        thigh = flexion[:, 0] + pitch
        shank = thigh - flexion[:, 1]
        foot = np.exp(1j * (shank + flexion[:, 2]))
        ankle = hip - 1j * (self.thigh * np.exp(1j * thigh) + self.shank * np.exp(1j * shank))
        return np.asarray(ankle[:, None] + foot[:, None] * (np.array([self.heel, self.toe]) - 1j * self.ankle))


class Condition(NamedTuple):
    """Condition under which a function may begin, or ends: a set of contacts and a range of flexion.

    Attributes:
        contacts: Feet and seat that bear load.
        lower: Least flexion of each leg [rad], (2, 3).
        upper: Largest flexion [rad], (2, 3).
    """

    contacts: Contacts
    lower: FloatArray
    upper: FloatArray

    def holds(self, contacts: Contacts, flexion: FloatArray) -> bool:
        """Tell whether the condition holds.

        Args:
            contacts: Feet and seat that bear load.
            flexion: Flexion of both legs [rad], (2, 3).

        Returns:
            Whether it does.
        """
        return contacts == self.contacts and bool(((flexion >= self.lower) & (flexion <= self.upper)).all())


@dataclass(frozen=True, eq=False, repr=False)
class Function:
    """One function of an exoskeleton as data, tabulated over :data:`PHASE`.

    Attributes:
        name: Name.
        duration: Time from phase 0 to 1 [s].
        flexion: Flexion of hip, knee and ankle of left and right leg [rad], (K, 2, 3).
        torso: Hip forward and up from the ground under the start [m], and pitch [rad], (K, 3).
        contacts: Sets of contacts in order, each with the phase at which it begins.
        entry: Condition of its beginning.
        exit: Condition of its end.
        cyclic: Whether phase 1 is followed by phase 0.
    """

    name: str
    duration: float
    flexion: FloatArray
    torso: FloatArray
    contacts: tuple[tuple[float, Contacts], ...]
    entry: Condition
    exit: Condition
    cyclic: bool = False

    def expected(self, phase: float) -> Contacts:
        """Look up the contacts that the function expects.

        Args:
            phase: Phase; of a cyclic function any number.

        Returns:
            Feet and seat that bear load.
        """
        p = phase % 1.0 if self.cyclic else min(max(phase, 0.0), 1.0)
        return [contacts for start, contacts in self.contacts if start <= p + 1e-9][-1]

    def __repr__(self) -> str:
        """Name the function, its duration and its contacts."""
        order = ", ".join("+".join(sorted(each)) or "air" for _, each in self.contacts)
        return f"Function({self.name}: {self.duration:g} s{', cyclic' if self.cyclic else ''}; {order})"


def joint_angles(leg: Leg, flexion: FloatArray) -> FloatArray:
    """Convert flexion of both legs to the joint angles of a machine, for any direction of its axes.

    Args:
        leg: Planar machine of two legs with hip, knee and perhaps ankle, left first.
        flexion: Flexion [rad], (K, 2, 3).

    Returns:
        Angles [rad], (K, n).

    Raises:
        ExoidError: The machine has not two such legs.
    """
    if len(leg.limbs) != len(SIDES) or any(limb.chain.n not in (2, 3) for limb in leg.limbs):
        raise BadArgumentError("no functions for these legs", where=leg.description.name, remedy="use two planar legs")
    return np.hstack(
        [flexion[:, k, : limb.chain.n] * (TURNS[: limb.chain.n] * limb.chain.signs) for k, limb in enumerate(leg.limbs)]
    )


def legs_flexion(leg: Leg, q: FloatArray) -> FloatArray:
    """Convert joint angles to flexion of both legs, the inverse of :func:`joint_angles`.

    Args:
        leg: Planar machine of two legs with hip, knee and perhaps ankle, left first.
        q: Angles [rad], (K, n).

    Returns:
        Flexion [rad], (K, 2, 3); zero of a missing ankle.
    """
    out = np.zeros((len(q), 2, 3))
    for k, limb in enumerate(leg.limbs):
        n = limb.chain.n
        out[:, k, :n] = q[:, limb.joints] * (TURNS[:n] * limb.chain.signs)
    return out


def contact_name(leg: Leg, link: str) -> str:
    """Name the contact of a link.

    Args:
        leg: Machine whose feet are on links that begin with their side.
        link: The link.

    Returns:
        "left", "right", or "seat" of the root link.
    """
    return SEAT if link == leg.description.root_link else next(side for side in SIDES if link.startswith(side))


def stride_flexion(reference: str | os.PathLike[str] = "healthy", scale: float = 0.9) -> FloatArray:
    """Tabulate hip, knee and ankle over a stride from heel contact: healthy gait, or a CSV file such as a norm.

    Args:
        reference: "healthy" for :func:`exoid.experiments.healthy_gait`, or a CSV file with columns ``phase`` (0 to 1),
            ``hip_deg``, ``knee_deg`` and perhaps ``ankle_deg``, flexion positive.
        scale: Factor of the amplitudes about the mean.

    Returns:
        Flexion at :data:`PHASE` [rad], (K, 3).

    Raises:
        ExoidError: There is no such file, or a column is missing.
    """
    whole = PHASE[:-1]
    if reference != "healthy":
        flexion = _csv_stride(Path(reference), scale)
    else:
        hip, knee = healthy_gait(scale, 1.0).over(whole).q.T
        knee = knee + np.deg2rad(5.0)  # the knee of the published stride is straight at heel contact
        tilt = scipy.interpolate.PchipInterpolator(*TILT_DEG)(whole)
        flexion = np.column_stack([hip, knee, np.deg2rad(scale * tilt) - hip + knee])
    return np.vstack([flexion, flexion[:1]])


def _csv_stride(path: Path, scale: float) -> FloatArray:
    """Read a stride from a CSV file, without the last phase."""
    try:
        table = np.genfromtxt(path, delimiter=",", names=True, dtype=np.float64, encoding="utf-8")
    except (OSError, ValueError) as error:
        raise UnreadableInputError(
            f"no table ({error})", where=str(path), remedy="give a CSV file with a header"
        ) from error
    names = table.dtype.names or ()
    column = {name: np.atleast_1d(table[name]) for name in names}  # type: ignore[call-overload]  # a structured array
    missing = [name for name in ("phase", "hip_deg", "knee_deg") if name not in names]
    if missing or table.size < 8:
        raise UnreadableInputError(
            f"{table.size} rows, without {', '.join(missing) or 'enough of them'}",
            where=str(path),
            remedy="give columns phase (0 to 1), hip_deg, knee_deg, and perhaps ankle_deg, of at least 8 phases",
        )
    phase = np.unwrap(2.0 * np.pi * column["phase"]) / (2.0 * np.pi)
    columns = [
        np.deg2rad(column[name]) if name in names else np.zeros(table.size)
        for name in ("hip_deg", "knee_deg", "ankle_deg")
    ]
    angles = np.column_stack(columns)
    if not np.isfinite(angles).all() or not (np.diff(phase) > 0.0).all() or phase[-1] - phase[0] < 0.9:
        raise UnreadableInputError(
            "the stride is not finite, or its phase does not rise over a whole stride",
            where=str(path),
            remedy="check its rows",
        )
    again = slice(0, -1) if phase[-1] - phase[0] > 1.0 - 1e-6 else slice(None)  # the last row may be the first one
    t, x = np.append(phase[again], phase[0] + 1.0), np.vstack([angles[again], angles[:1]])
    found = scipy.interpolate.CubicSpline(t, x, bc_type="periodic")(t[0] + (PHASE[:-1] - t[0]) % 1.0)
    return np.asarray(found.mean(axis=0) + scale * (found - found.mean(axis=0)))


def stand(body: Body) -> Function:
    """Stand on both feet.

    Args:
        body: The wearer.

    Returns:
        The function, of one second.
    """
    hip = np.full(len(PHASE), STANDING * 1j * body.leg)
    return _placed("stand", body, 1.0, hip, np.zeros(len(PHASE)), ((0.0, frozenset(SIDES)),))


def sit(body: Body, *, seat: float = 0.45, duration: float = 2.5, lean: float = -0.5) -> Function:
    """Sit down on a chair behind the feet.

    Args:
        body: The wearer.
        seat: Height of the seat [m].
        duration: Duration [s].
        lean: Pitch of the torso half-way [rad]; negative leans forward.

    Returns:
        The function; the seat bears load from 0.85 of it.

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    standing, seated = STANDING * 1j * body.leg, seated_hip(body, seat)
    s = minimum_jerk(PHASE / 0.9)  # and rests
    hip = np.asarray(standing + s * (seated - standing), dtype=np.complex128)
    pitch = lean * np.sin(np.pi * s) ** 2
    order = ((0.0, frozenset(SIDES)), (0.85, frozenset((*SIDES, SEAT))))
    return _placed("sit", body, duration, hip, pitch, order)


def seated_hip(body: Body, seat: float) -> complex:
    """Locate the hip of a seated wearer, whose shanks lean back by 0.1 rad, from the middle of the soles.

    Args:
        body: The wearer.
        seat: Height of the seat [m].

    Returns:
        Place of the hip [m].

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    up = seat + body.seat
    knee = -0.5 * (body.heel + body.toe) + 1j * body.ankle + body.shank * np.exp(1j * (0.5 * np.pi - 0.1))
    drop = up - knee.imag
    if not abs(drop) < 0.9 * body.thigh:
        raise BadArgumentError(f"a seat of {seat:g} m for a leg of {body.leg:.3g} m", remedy="0.4 to 0.5 m are usual")
    return complex(knee.real - np.sqrt(body.thigh**2 - drop**2), up)


def rise(body: Body, *, seat: float = 0.45, duration: float = 2.5) -> Function:
    """Stand up from a chair: sitting down in reverse.

    Args:
        body: The wearer.
        seat: Height of the seat [m].
        duration: Duration [s].

    Returns:
        The function; seat-off is planned at 0.15 of it.

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    down = sit(body, seat=seat, duration=duration)
    order = ((0.0, frozenset((*SIDES, SEAT))), (0.15, frozenset(SIDES)))
    return _function("rise", duration, down.flexion[::-1], down.torso[::-1], order)


def walk(
    body: Body,
    *,
    reference: str | os.PathLike[str] = "healthy",
    scale: float = 0.9,
    period: float = 1.4,
    pitch: float = 0.0,
    lift: float = 0.015,
    angle: float = 0.0,
) -> Function:
    """Walk: both legs follow a stride, half a period apart, and the lowest point of the soles rests.

    Args:
        body: The wearer.
        reference: Stride, see :func:`stride_flexion`.
        scale: Factor of the amplitudes about the mean.
        period: Time of a stride [s].
        pitch: Pitch of the torso [rad]. Norms count the flexion of the hip from a pelvis that leans by −0.19 rad.
        lift: Height by which a swinging foot is lifted more than in the reference [m].
        angle: Angle by which the ground rises forward [rad]. The walk turns with it, and the torso keeps its pitch.

    Returns:
        The function, "walk" or "slope"; phase 0 is the heel contact of the left foot.

    Raises:
        ExoidError: There is no such reference, a leg is too short, or the slope is above 0.3 rad.
    """
    checked(abs(angle), "the angle of a slope [rad]", most=0.3)
    one = stride_flexion(reference, scale)
    both = np.stack([one, np.vstack([one[100:], one[1:101]])], axis=1)
    if body.ankle == 0.0:
        both[..., 2] = 0.0
    soles = [body.sole(np.zeros(len(PHASE), dtype=np.complex128), pitch, both[:, k]) for k in range(2)]
    low = np.array([sole.imag.min(axis=1) for sole in soles])
    smooth = 0.02 * len(PHASE)
    up = scipy.ndimage.gaussian_filter1d(-low.min(axis=0)[:-1], smooth, mode="wrap")
    load = np.exp(-(low - low.min(axis=0)) / 0.01)[:, :-1]  # passes from foot to foot over 1 cm
    middle = np.array([s.real.mean(axis=1) for s in soles])[:, :-1]
    speed = -((np.roll(middle, -1, axis=1) - np.roll(middle, 1, axis=1)) * 0.5 * load).sum(axis=0) / load.sum(axis=0)
    speed = scipy.ndimage.gaussian_filter1d(speed, smooth, mode="wrap")
    hip = np.append(0.0, np.cumsum(speed)) + 1j * np.append(up, up[0])
    flexion = []
    for k in range(2):
        sole = body.sole(hip, pitch, both[:, k])
        height = np.maximum(sole.imag.min(axis=1), 0.0)
        raised = sole.mean(axis=1) + 1j * lift * height / (height + 0.01)
        tilt = np.angle(sole[:, 1] - sole[:, 0])
        found = body.reach(hip, pitch, raised, tilt if body.ankle else np.zeros(len(PHASE)))
        found[:, 2] *= bool(body.ankle)
        flexion.append(found)
    down = np.array(
        [body.sole(hip, pitch, each).imag.min(axis=1) < DOWN + low.min(axis=0) + hip.imag for each in flexion]
    )
    down |= ~down.any(axis=0) & (low == low.min(axis=0))  # never in the air
    order = _order([frozenset(side for side, flag in zip(SIDES, flags, strict=True) if flag) for flags in down.T])
    hip = hip * np.exp(1j * angle)
    torso = np.column_stack([hip.real, hip.imag, np.full(len(PHASE), pitch)])
    both = np.stack(flexion, axis=1) + np.array([angle, 0.0, 0.0])
    return _function("slope" if angle else "walk", period, both, torso, order, cyclic=True)


def stairs(body: Body, *, up: bool = True, riser: float = 0.17, tread: float = 0.29, period: float = 2.4) -> Function:
    """Climb or descend stairs foot over foot; phase 0 is the contact of the left foot with the first step.

    Args:
        body: The wearer.
        up: Whether up, or down.
        riser: Height of a step [m].
        tread: Depth of a step [m].
        period: Time of two steps [s].

    Returns:
        The function. The right foot begins at the origin, one step behind.

    Raises:
        ExoidError: The steps are too high or too deep for the legs.
    """
    checked([riser, tread], "riser and tread [m]", above=0.0, most=0.6)
    step = tread + 1j * (riser if up else -riser)
    lift_off = 0.62  # phase of its own contact at which a foot leaves
    own = {"left": PHASE, "right": (PHASE + 0.5) % 1.0 + (PHASE == 0.5)}
    begin = {"left": np.full(len(PHASE), step), "right": np.where(PHASE <= 0.5, 0.0, 2.0 * step)}
    tilt = {side: np.deg2rad(scipy.interpolate.PchipInterpolator(*STAIR_TILT_DEG[up])(u)) for side, u in own.items()}
    if body.ankle == 0.0:
        tilt = dict.fromkeys(SIDES, 0.0 * PHASE)
    feet = {}
    for side, u in own.items():
        s = np.clip((u - lift_off) / (1.0 - lift_off), 0.0, 1.0)
        # a foot turns about its toe, whose place is that of a level sole
        feet[side] = (
            begin[side] + _swing(s, 2.0 * step) + 0.5 * (body.toe - body.heel) * (1.0 - np.exp(1j * tilt[side]))
        )
    ahead, height = (0.3, 0.90) if up else (0.2, 0.94)
    # the hip rises or sinks while one foot bears it: at touch-down the leg behind, or that ahead, is long
    sunk = (2.0 * PHASE) // 1.0 + minimum_jerk((2.0 * PHASE) % 1.0)
    level = riser * sunk if up else -riser * (sunk + 1.0)
    hip = tread * (2.0 * PHASE + ahead) + 1j * (height * body.leg + level)
    double = lift_off - 0.5
    order = (
        (0.0, frozenset(SIDES)),
        (double, frozenset(("left",))),
        (0.5, frozenset(SIDES)),
        (0.5 + double, frozenset(("right",))),
    )
    name = "stairs up" if up else "stairs down"
    return _placed(name, body, period, hip, np.zeros(len(PHASE)), order, feet=feet, tilt=tilt, cyclic=True)


def _swing(s: FloatArray, way: complex) -> ComplexArray:
    """Path of a swinging foot: up before forward, forward before down; s from 0 to 1."""
    early, late = minimum_jerk(s / 0.7), minimum_jerk((s - 0.3) / 0.7)
    forward, up = (late, early) if way.imag > 0.0 else (early, late)
    clearance = 0.05 * np.sin(np.pi * s) ** 2
    return np.asarray(way.real * forward + 1j * (way.imag * up + clearance))


def minimum_jerk(s: ArrayLike) -> FloatArray:
    """Rise from 0 to 1 with zero velocity and acceleration at both ends, 10 s³ − 15 s⁴ + 6 s⁵.

    Args:
        s: Argument, clipped to 0 to 1.

    Returns:
        The polynomial.

    Example:
        >>> minimum_jerk([0.0, 0.5, 1.0, 2.0])
        array([0. , 0.5, 1. , 1. ])
    """
    s = np.clip(np.asarray(s, dtype=np.float64), 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s * s))


def _placed(
    name: str,
    body: Body,
    duration: float,
    hip: ComplexArray,
    pitch: FloatArray,
    order: tuple[tuple[float, Contacts], ...],
    *,
    feet: Mapping[str, ComplexArray] | None = None,
    tilt: Mapping[str, FloatArray] | None = None,
    cyclic: bool = False,
) -> Function:
    """Function whose soles are at given places or at the origin, and level or tilted."""
    origin = dict.fromkeys(SIDES, np.zeros(len(PHASE), dtype=np.complex128))
    places, turn = feet or origin, tilt or dict.fromkeys(SIDES, np.zeros(len(PHASE)))
    flexion = np.stack([body.reach(hip, pitch, places[side], turn[side]) for side in SIDES], axis=1)
    if body.ankle == 0.0:
        flexion[..., 2] = 0.0
    return _function(name, duration, flexion, np.column_stack([hip.real, hip.imag, pitch]), order, cyclic=cyclic)


def _function(
    name: str,
    duration: float,
    flexion: FloatArray,
    torso: FloatArray,
    order: tuple[tuple[float, Contacts], ...],
    *,
    cyclic: bool = False,
) -> Function:
    checked(duration, f"the duration of {name} [s]", above=0.0, most=60.0)
    entry, exit_ = (
        Condition(each, x - ROOM, x + ROOM) for each, x in ((order[0][1], flexion[0]), (order[-1][1], flexion[-1]))
    )
    return Function(name, duration, flexion, torso, order, entry, exit_, cyclic)


def _order(sets: list[Contacts]) -> tuple[tuple[float, Contacts], ...]:
    """Join equal sets that follow each other."""
    starts = [k for k in range(len(sets)) if k == 0 or sets[k] != sets[k - 1]]
    return tuple((float(PHASE[k]), sets[k]) for k in starts)


FUNCTIONS = {
    "stand": stand,
    "sit": sit,
    "rise": rise,
    "walk": walk,
    "stairs up": lambda body, **options: stairs(body, up=True, **options),
    "stairs down": lambda body, **options: stairs(body, up=False, **options),
    "slope": lambda body, angle=0.08, **options: walk(body, angle=angle, **options),
}
"""Functions by name: each makes its data for a :class:`Body`."""
