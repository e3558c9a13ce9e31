"""Bias of an inertial measurement unit, found while a foot rests on the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations, permutations, product
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.signals import BaseMotion, Recording

from .standing_base import StandingBase, standing_reading, tilt_of_sole

LEAST = 1.0  # shortest rest of all feet together from which a bias is estimated [s]
TURNING = 0.06  # a foot that turns faster rolls over heel or toe [rad/s]
ENDS = 0.07  # time at both ends of a rest that the differentiation of the pose draws on [s]

ROCKS = 0.05
"""Feet that lean otherwise by more than this part of gravity [m/s², standard deviation], 5 mrad, rock."""

DEAD = 0.03
"""Scale of a gyroscope that is dead, or that reads rad/s as degrees."""


class ImuErrors(NamedTuple):
    """Errors of an inertial measurement unit on the base, in the axes of the base."""

    gyro_bias: FloatArray  # offset of the angular velocity [rad/s], (3,)
    force_bias: FloatArray  # offset of the specific force [m/s²], (3,)
    std: FloatArray  # standard deviations of the six numbers above, in their order, (6,)
    rocks: float = 0.0  # angle by which the feet rock [rad, standard deviation], which then tell nothing
    turn: FloatArray = np.zeros((3, 3))  # mean turn of level axes into those of the base, while feet rested
    delay: float = 0.0  # time by which it reads later than the angles [s], which was taken out before

    def corrected(self, base: BaseMotion) -> BaseMotion:
        """Take the errors out of readings."""
        omega, force = base.angular_velocity - self.gyro_bias, base.specific_force - self.force_bias
        return BaseMotion(omega, force, base.position, base.pose, calibrated=True)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class CorrectedBase(BaseMotion):
    """Motion of a base without the bias of its sensor, which feet told as if the ground were level."""

    told: ImuErrors  # what feet told
    own: bool  # whether feet of this recording did, not those of another one of the session
    bias: FloatArray  # offset of the specific force that was taken out [m/s²], (3,)

    def leaning(self, lean: FloatArray) -> CorrectedBase:
        """Let the feet rest on ground that leans by a rotation vector [rad]."""
        # By level ground gravity points along Rᵀ ḡ, by ground that leans with the turn T along Rᵀ Tᵀ ḡ
        up = np.array([0.0, 0.0, GRAVITY])
        tilted = scipy.spatial.transform.Rotation.from_rotvec(lean).apply(up, inverse=True)
        bias = self.told.force_bias + self.told.turn @ (up - tilted)
        return replace(self, specific_force=self.specific_force + self.bias - bias, bias=bias)


def imu_errors(
    base: BaseMotion, still: Mapping[str, StandingBase], resting: Mapping[str, NDArray[np.bool_]], rate: float
) -> ImuErrors | None:
    """Compare an inertial measurement unit with what it would read on each foot, while this is flat on the ground."""
    # Readings are ω' = ω + b_ω and f' = f + b_f with biases b. A foot that rolls over heel or toe turns against the
    # gyroscope.
    rests = [rest for link, flags in resting.items() if flags.any() for rest in _rests(base, still[link], flags, rate)]
    if sum(len(gyro) for gyro, *_ in rests) < LEAST * rate:
        return None
    of_gyro, of_force, turns = (np.concatenate(arrays) for arrays in zip(*rests, strict=True))
    means = np.array([np.concatenate([gyro.mean(axis=0), force.mean(axis=0)]) for gyro, force, _ in rests])
    shares = np.array([len(gyro) for gyro, *_ in rests]) / len(of_gyro)  # pieces of some samples say little
    spread = shares @ (means - shares @ means) ** 2
    apart = float(np.sqrt(spread[3:].sum()))
    # Of 17 walkers, seeds below 20, biases that feet tell differ by 0.040 to 0.069 m/s² where they rock, else by 0.021
    if apart > 0.03:
        return ImuErrors(np.zeros(3), np.zeros(3), np.full(6, np.inf), rocks=apart / GRAVITY)
    gyro, force = (np.zeros(3) if _within_scatter(x) else x.mean(axis=0) for x in (of_gyro, of_force))
    left = (x - (x.mean(axis=0) if _within_scatter(x) else 0.0) for x in (of_gyro, of_force))
    std = np.repeat([x.std() / np.sqrt(len(x)) for x in left], 3)
    if len(means) > 2:  # rests may differ by more than white noise
        std = np.maximum(std, np.sqrt(spread / (1.0 / (shares @ shares) - 1.0)))
    return ImuErrors(gyro, force, std, turn=turns.mean(axis=0))


def refuse_turned(
    leg: Leg, log: Recording, still: Mapping[str, StandingBase], resting: Mapping[str, NDArray[np.bool_]]
) -> None:
    """Refuse what other axes of the sensor of the base, another foot, or other angles explain far better."""
    base, rate = log.base, log.sample_rate
    assert base is not None
    for link, stands in still.items():
        alone = resting[link] & ~np.any([flags for other, flags in resting.items() if other != link], axis=0)
        rows = np.flatnonzero(alone if np.count_nonzero(alone) > LEAST * rate else resting[link])
        if len(rows) < LEAST * rate:
            continue
        rows = rows[:: 1 + len(rows) // 2000]
        read, said = (_weighted(one, rate, rows) for one in (base, stands))
        # Feet may roll, and sensors be biased: only what is far nearer for most of the time counts. Right axes of a
        # turned sensor leave 0.02 to 0.1 of what is left as logged, interchanged feet 0.03. Healthy sensors are turned
        # by 0.004 rad, and scaled by 1.04 at most (walkers, seeds 20 to 34, 1001 and 1002, with all kinds of ground).
        apart = _apart(read, said)
        what, remedy, least, turned, scale = "", "", min(0.3 * apart, TURNING), np.zeros(3), 1.0
        if said[:, :3].std(axis=0).max() > TURNING / 3.0:
            turned, scale = _followed(read[:, :3], said[:, :3])
        if apart > 0.06 and scale > DEAD:  # a lean of 7° explains as much [rad/s]
            others = {other: x for other, x in still.items() if not resting[other][rows].any()}
            for other, meaning, advice in _explanations(leg, log, link, [read, said], others, rows):
                if (left := _apart(read, other)) < least:  # others are more far-fetched
                    what, remedy, least = meaning, advice, 0.5 * left
        if not what and np.linalg.norm(turned) > 0.06:
            what, remedy = _mounting(turned)
        elif not what and abs(np.log(max(scale, 1e-9))) > np.log(1.1):
            what = f"the gyroscope of the base reads {scale:.2g} times what the base turns on {link}"
            remedy = "look at its unit, range and connection, or leave its columns out: feet then tell the motion"
            if scale < DEAD and read[:, 3:].std(axis=0).max() < 0.3 * said[:, 3:].std(axis=0).max():
                what = f"by both its sensors the base is held, and on {link}, which is said to rest, it would turn"
                remedy = f"check the switch of {link}, which is dead if it never changes"
        if what:
            raise UnreadableInputError(what, where=log.file_name, remedy=remedy)


def _explanations(
    leg: Leg, log: Recording, link: str, pair: list[FloatArray], feet: dict[str, StandingBase], rows: NDArray[np.intp]
) -> Iterator[tuple[FloatArray, str, str]]:
    """Say what a sensor of a base on a link would read with other axes, on another foot, and by other angles."""
    assert log.base is not None
    remedy, rate = "give readings in the axes of the root link (rotation=, or other columns and signs)", log.sample_rate
    read, said = (x.reshape(-1, 3) for x in pair)
    signed = (
        np.diag(signs)[list(order)] for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)
    )
    for turn in sorted(signed, key=np.linalg.det, reverse=True):  # right-handed axes first
        axes = ", ".join(("-" if sum(x) < 0.0 else "") + "xyz"[int(np.argmax(np.abs(x)))] for x in turn.T)
        what = f"the base's sensor turns against {link}, which stands: x, y and z of the root link are its {axes}"
        yield (said @ turn.T).reshape(-1, 6), what, remedy
    least = 0.03 * np.linalg.norm(said) * np.eye(3)  # at rest, no turn about the vertical shows
    other, _ = scipy.spatial.transform.Rotation.align_vectors(np.vstack([read, least]), np.vstack([said, least]))
    yield other.apply(said).reshape(-1, 6), *_mounting(other.as_rotvec())
    remedy = "interchange the contacts of the feet, or the angles of the legs; or a switch is inverted"
    for foot, stands in feet.items():
        what = f"the base moves as if {foot} stood, and the log says that {link} does"
        yield _weighted(stands, rate, rows), what, remedy
    remedy = "map the columns by name (columns=, --column NAME=HEADER), or negate the angle"
    for change, q in angle_mistakes(log):
        stands = standing_reading(leg, replace(log, q=q), link, log.base.position)
        yield _weighted(stands, rate, rows), f"the base moves on {link} as if {change}", remedy


def angle_mistakes(log: Recording) -> Iterator[tuple[str, FloatArray]]:
    """Angles with another sign, or with two columns interchanged, and what was wrong with them."""
    names, q, every = log.joint_names, log.q, np.arange(log.q.shape[1])
    for j in every.tolist():
        yield f"the angle of {names[j]} had the other sign", np.where(every == j, -q, q)
    for j, k in combinations(every.tolist(), 2):
        order = np.where(every == j, k, np.where(every == k, j, every))
        yield f"the angles of {names[j]} and {names[k]} were interchanged", q[:, order]


def _mounting(turned: FloatArray) -> tuple[str, str]:
    """Say that a sensor is turned by a rotation vector, and what to do."""
    angle, about = np.linalg.norm(turned), ", ".join(f"{x:.2f}" for x in turned / np.linalg.norm(turned))
    what = f"the base's sensor is turned by {np.rad2deg(angle):.0f}° about ({about}) of the root link"
    return what, "look at its mounting (rotation=, or its inverse), the zeros of the angles, and the lean of the ground"


def _weighted(base: BaseMotion, rate: float, rows: NDArray[np.intp]) -> FloatArray:
    """Smooth readings, of which 1 m/s² counts as much as a turn of 0.05 rad/s, (N, 6)."""
    smooth = scipy.ndimage.gaussian_filter1d(base.columns * np.repeat([1.0, 0.05], 3), 0.04 * rate, axis=0)
    return np.asarray(smooth[rows])


def _followed(read: FloatArray, said: FloatArray) -> tuple[FloatArray, float]:
    """Turn from the axis about which the base turns most to that of rates that follow [rad], (3,), and their scale."""
    x, y = read - read.mean(axis=0), said - said.mean(axis=0)
    axis = np.linalg.eigh(y.T @ y).eigenvectors[:, -1]
    follows = (y @ axis) @ x / np.sum((y @ axis) ** 2)  # by noise about other axes it hardly turns
    normal = np.cross(axis, follows)
    length = float(np.linalg.norm(normal))
    sure = np.linalg.norm(follows) > 0.5 and axis @ follows > 0.0 and length > 0.0  # else the foot rolls
    scale = float(np.linalg.norm(x) / np.linalg.norm(y))
    # both are correlated; soles that yield in a walk roll with the base, by 0.003 rad/s
    alike = scale < DEAD or (axis @ follows > 0.98 * scale and abs(scale - 1.0) * y.std() > 0.006)
    return normal * (np.arctan2(length, axis @ follows) / length if sure else 0.0), scale if alike else 1.0


def _apart(read: FloatArray, said: FloatArray) -> float:
    """How far readings of a sensor, whose gyroscope may be biased, are from others (median)."""
    difference = read - said
    difference[:, :3] -= np.median(difference[:, :3], axis=0)
    return float(np.median(np.linalg.norm(difference, axis=1)))


def turns_on_feet(
    leg: Leg, log: Recording, still: Mapping[str, StandingBase], resting: Mapping[str, NDArray[np.bool_]]
) -> FloatArray:
    """Sum products of what errors of a sensor would read while feet are flat, and of what it reads beside, (6, 6)."""
    # It may be 1 m away along each axis, where f' = f + α × r + ω × (ω × r) as BaseKinematics.specific_force_at, 1 s
    # late, or read twice as much. Biases are slow: means of each rest are left out. So are a lean of the ground, which
    # turns with the base, and soles that yield under their torque, at once and with time, as a late sensor seems to.
    base, rate, tables = log.base, log.sample_rate, [np.zeros((0, 10))]
    assert base is not None
    for link, flags in resting.items():
        rests = still[link]
        assert rests.pose is not None
        level = np.moveaxis(rests.pose.rotation[:, :2], 1, 0)  # level axes in those of the base
        lean, omega = tilt_of_sole(leg, log, link)[:, :2, np.newaxis], rests.angular_velocity
        yields = lean[:, 1] * level[0] - lean[:, 0] * level[1]
        slow, alpha, later = (np.gradient(x, axis=0) * rate for x in (yields, omega, -rests.specific_force))
        arms = (np.cross(alpha, e) + np.cross(omega, np.cross(omega, e)) for e in np.eye(3))
        read = rests.specific_force, base.specific_force - rests.specific_force
        columns = np.stack([*level, yields, slow, *arms, later, *read], axis=-1)
        columns = scipy.ndimage.gaussian_filter1d(columns, 0.04 * rate, axis=0)
        inner = scipy.ndimage.binary_erosion(flags, iterations=max(1, round(2.0 * ENDS * rate)))
        changes = np.flatnonzero(np.diff(inner, prepend=False, append=False)).reshape(-1, 2).tolist()
        pieces = (columns[start:end] for start, end in changes if end - start > LEAST * rate)
        tables += [(piece - piece.mean(axis=0)).reshape(-1, 10) for piece in pieces]
    of_ground, errors = np.hsplit(np.vstack(tables), [4])
    of_ground /= np.maximum(np.linalg.norm(of_ground, axis=0), 1e-12)
    errors -= of_ground @ np.linalg.lstsq(of_ground, errors, rcond=0.1)[0]
    return np.asarray(errors.T @ errors)


def misread(turns: FloatArray) -> tuple[FloatArray, float]:
    """Find how far a sensor is from its place, in axes of the base [m], (3,), or how many times it reads the force."""
    place = np.linalg.pinv(turns[:3, :3], rcond=0.01, hermitian=True) @ turns[:3, 5]  # turns about one axis tell two
    scale = turns[4, 5] / turns[4, 4] if turns[4, 4] else 0.0
    # Of what is quick in the difference from the feet (variance), right places explain 0.042 at most, and places 7 cm
    # off 0.188 at least, right scales 0.005, and 1.03 or 0.98 at least 0.12, more than a place does (14 walkers, seeds
    # 20 to 34). Feet that rock explain 0.5, by a place 0.75 m away: the ground.
    shares = np.array([place @ turns[:3, 5], scale * turns[4, 5]])
    told = shares > max(0.1 * turns[5, 5], shares.max() - 1e-12 * turns[5, 5])
    return place * (told[0] and 0.03 < np.linalg.norm(place) < 0.5), 1.0 + scale * float(told[1])


def late(turns: FloatArray, *, rocks: bool = False) -> float:
    """Find how much later than the angles a sensor reads, as turns on flat feet tell [s], or zero."""
    # Of the same variance, in one recording, a delay explains 0.07 at most on time, also on soft ground, and 0.16 at
    # least where it is 20 ms and no foot rocks (14 walkers, seeds 20 to 34). Without noise 5 ms do. Where feet rock, 51
    # ms that are none explain 0.13, and 79 ms instead of 30 explain 0.27 (seed 12); on soft soles 24 ms explain 0.81.
    delay = turns[3, 5] / max(turns[3, 3], 1e-300)
    return float(delay) if abs(delay) > 0.01 and delay * turns[3, 5] > (0.5 if rocks else 0.1) * turns[5, 5] else 0.0


def _within_scatter(differences: FloatArray) -> bool:
    """Whether the mean of differences, (N, 3), is small beside their scatter: a foot is not exactly still."""
    # Biases below this part of the scatter of the differences are left: soft ground moves a foot as much
    return bool(np.linalg.norm(differences.mean(axis=0)) < 0.1 * np.linalg.norm(differences.std(axis=0)))


def _rests(base: BaseMotion, still: StandingBase, flags: NDArray[np.bool_], rate: float) -> list[list[FloatArray]]:
    """Differences of gyroscope and of accelerometer from a foot that is flat, and turns of level axes to the base."""
    assert still.pose is not None  # of each rest, and piece of a long one: a rocking foot leans otherwise in the next
    aside, flat = np.hsplit(base.columns - still.columns, 2), flags
    # a foot that rolls turns, and one that has tipped onto heel or toe leans, by so much [m/s²]: mostly it does neither
    for difference, width in zip(aside, (TURNING, 0.15), strict=True):
        smooth = scipy.ndimage.uniform_filter1d(difference, max(1, round(ENDS * rate)), axis=0)
        middle = np.array([_densest(of_axis, width) for of_axis in smooth[flags].T])
        flat = flat & (np.linalg.norm(smooth - middle, axis=1) < width)
    places = np.flatnonzero(scipy.ndimage.binary_erosion(flat, iterations=max(1, round(ENDS * rate))))
    cuts = np.flatnonzero((np.diff(places) > 1) | (np.diff(places // round(1.5 * rate)) > 0)) + 1
    arrays = (*aside, np.swapaxes(still.pose.rotation, 1, 2))
    pieces = zip(*(np.split(array[places], cuts) for array in arrays), strict=True)
    return [list(piece) for piece in pieces if len(piece[0])]


def _densest(values: FloatArray, width: float) -> float:
    """Middle of the values that have most others within a distance: at rest, while others spread."""
    ordered = np.sort(values)
    around = np.searchsorted(ordered, ordered + width) - np.searchsorted(ordered, ordered - width)
    best = ordered[int(np.argmax(around))]
    return float(np.median(ordered[np.abs(ordered - best) <= width]))
