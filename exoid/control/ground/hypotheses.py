"""Which feet, and whether a seat, bear the machine: a hidden Markov filter over sets of contacts (Rabiner 1989)."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.control.functions import Contacts, contact_name
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.estimate import EstimateData
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.link_frames import held_directions
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import Sole
from exoid.torques.model import TorqueModel

CERTAIN = 0.99
"""Probability from which a set of contacts counts as known."""

BLOCK = 0.01
"""Time between two decisions [s]."""


class ContactNoise(NamedTuple):
    """Standard deviations of what is not in the model, and prior rates, chosen on the rig."""

    angle: float = 1e-4  # noise of encoders [rad]
    torque: float = 0.5  # noise of torques [N·m]
    gyro: float = 0.005  # noise of the gyroscope [rad/s]
    acceleration: float = 0.05  # noise of the accelerometer [m/s²]
    force: float = 6.0  # error of the model in base rows [N], beside that of its parameters
    moment: float = 1.5  # error of the model in rows of joints and of the pitch [N·m]
    relative: float = 0.04  # error of the model over the size of each row, as after a step that filters smear
    cone: float = 1.2  # ratio of force along and across the ground from which a contact counts as impossible
    slide: float = 0.35  # velocity of the middles of two soles that bear, against each other, as they roll [m/s]
    freedom: float = 4.0  # degrees of freedom of Student's t: jolts are no evidence against a contact
    temper: float = 0.5  # share of the evidence of a block that is new, as filtered samples depend on each other
    change: float = 0.02  # probability that a contact changes in a block
    switch: float = 0.85  # probability that a healthy switch is right, late ones included
    late: float = 0.08  # time over which the readings of a switch are one piece of evidence [s]
    misfit: float = 1.4  # mean log(1 + distance / freedom) of the best set from which a sensor must be wrong
    freezes: float = 0.03  # time for which a reading does not change at all: the sensor is frozen [s]
    moves: float = 0.2  # velocity of a joint from which the machine moves, so that a reading has to change [rad/s]
    # least speed of its joints, in rad/s and over that when an encoder changed last: it explains the time to the next
    # step. Encoders of 11 to 16 bits need 2.4 times and twice the speeds given here, on a walk, stairs, sit and rise.
    creeps: float = 1e-3
    slows: float = 1.0 / 30.0
    agrees: float = 0.2  # time over which motion and torque must agree by some set [s]
    distrusted: float = 1.0  # time for which all sets are unknown if they do not [s]
    surprise: float = 0.1  # probability in a block of a set that the function does not expect, over one that it does


class ContactReadings(NamedTuple):
    """Readings of N samples at the rate of the filter.

    Attributes:
        q: Joint angles [rad], (N, n).
        tau: Torques of the actuators [N·m], (N, n).
        gyro: Angular velocity of the base [rad/s], (N, 3).
        force: Specific force at the sensor [m/s²], (N, 3).
        known: Rows of measured forces, such as those of crutches [N, N·m], (N, base_rows + n); None for none.
        switches: Whether the switch of a foot is closed, (N,) each; a link without a switch is left out.
    """

    q: FloatArray
    tau: FloatArray
    gyro: FloatArray
    force: FloatArray
    known: FloatArray | None = None
    switches: Mapping[str, BoolArray] = {}


class Belief(NamedTuple):
    """Probabilities of the sets of contacts after K blocks.

    Attributes:
        probability: Probability of each hypothesis, (K, H).
        wrench: Expected force forward and up [N] and moment [N·m] on each sole, in its axes about its middle, given
            the most probable set, (K, S, 3); zero for a sole that is not in it.
    """

    probability: FloatArray
    wrench: FloatArray


@dataclass
class Memory:
    """What the filter keeps between two calls: states of its low-passes, last probabilities, doubts of switches."""

    channels: list[FloatArray] | None  # states of the low-passes; None before the first sample
    probability: FloatArray  # (H,)
    disagreement: FloatArray  # running share of the time in which each switch contradicts the torques, (F,)
    misfit: float = 0.0  # running mean of the misfit of the best set
    distrusted: float = 0.0  # time for which contacts stay unknown [s]
    left: int = 0  # samples since the last block
    last: FloatArray | None = None  # last sample of angles, torques and gyroscope
    still: NDArray[np.intp] | None = None  # samples for which each of them has not changed
    step: FloatArray | float = 2.0 * np.pi / 2**12  # smallest change of each angle [rad]; 12 bits until it changes
    pace: FloatArray | float = 0.0  # speed of each joint when its angle changed last [rad/s]
    frozen: BoolArray | bool = False  # which of them did not change while the machine moved, and still do not


@dataclass(frozen=True, eq=False, repr=False)
class ContactFilter:
    """Hidden Markov filter over the sets of contacts of an identified machine with a floating base.

    The rows e = Y β − [0; τ] − Σ Jᵀw of known forces are what unknown contacts explain. A set h with Jacobian J_h and
    forces f ~ N(0, P) makes e ~ N(0, Σ + J_hᵀ P J_h): its part N_hᵀ e outside the contacts is an innovation, and a
    contact that is not needed costs evidence (MacKay 2003, ch. 28). Σ holds the covariance of β, noise and model error.
    All channels pass the same causal low-pass. Use :meth:`of`.

    Attributes:
        model: Torque model of the estimate.
        values: Its parameters, (P,).
        covariance: Their covariance, (P, P).
        soles: Sole of each link that may bear load; one of the root link is a seat.
        imu_position: Place of the IMU in the axes of the root link [m], (3,).
        rate: Rate of the readings [Hz].
        cutoff: Cut-off frequency of the low-pass [Hz], which delays by 3/(2π cutoff).
        noise: Noise and prior rates.
    """

    model: TorqueModel
    values: FloatArray
    covariance: FloatArray
    soles: Mapping[str, Sole]
    imu_position: FloatArray
    rate: float = 500.0
    cutoff: float = 40.0
    noise: ContactNoise = field(default_factory=ContactNoise)

    @classmethod
    def of(
        cls,
        estimate: EstimateData,
        soles: Mapping[str, Sole],
        imu_position: Sequence[float] = (0.0, 0.0, 0.0),
        *,
        rate: float = 500.0,
    ) -> ContactFilter:
        """Make the filter of an estimate.

        Args:
            estimate: Estimate of a planar machine with a floating base.
            soles: Sole of each link that may bear load, see :class:`exoid.rig.ground.Sole`; one of the root link is a
                seat.
            imu_position: Place of the IMU in the axes of the root link [m].
            rate: Rate of the readings [Hz].

        Returns:
            The filter.

        Raises:
            ExoidError: The base does not float, or there are too many contacts or none.
        """
        leg = estimate.leg
        if leg.base != "floating" or leg.base_rows != 3:
            raise NotSupportedError(
                "contacts are told from the rows of a planar machine with a floating base",
                where=leg.description.name,
                remedy='identify the legs with base="floating"',
            )
        if not 1 <= len(soles) <= 3:
            raise BadArgumentError(f"{len(soles)} soles", remedy="give one to three: two feet and a seat")
        if not rate >= 4.0 * cls.cutoff:
            raise BadArgumentError(f"readings at {rate:g} Hz", remedy=f"give {4.0 * cls.cutoff:g} Hz or more")
        numbers = np.asarray(estimate.values), np.asarray(estimate.covariance)
        return cls(estimate.model, *numbers, dict(soles), np.asarray(imu_position, dtype=np.float64), rate)

    @cached_property
    def sets(self) -> tuple[frozenset[str], ...]:
        """Sets of contacts, one a hypothesis; the last hypothesis, the unknown, has none."""
        return tuple(frozenset(links) for k in range(len(self.soles) + 1) for links in combinations(self.soles, k))

    @cached_property
    def feet(self) -> tuple[str, ...]:
        """Links with soles that are not the root link."""
        return tuple(link for link in self.soles if link != self.model.leg.description.root_link)

    @property
    def numbers(self) -> dict[str, float]:
        """Tuned numbers by their names in C."""
        return self.noise._asdict() | {"surprise": float(np.log(self.noise.surprise)), "block": BLOCK}

    def begin(self, contacts: Iterable[str] | None = None) -> Memory:
        """Make the memory before the first sample.

        Args:
            contacts: Links that bear load; None if all sets are equally probable.

        Returns:
            The memory.
        """
        H, known = len(self.sets) + 1, None if contacts is None else self.sets.index(frozenset(contacts))
        return Memory(None, np.full(H, 1.0 / H) if known is None else np.eye(H)[known], np.zeros(len(self.feet)))

    def chances(self, row: FloatArray) -> dict[Contacts, float]:
        """Name the sets as functions do.

        Args:
            row: Probability of each hypothesis, (H,).

        Returns:
            Probability of each set of "left", "right" and "seat"; what is missing to 1 is unknown.
        """
        return dict(zip(self._names, map(float, row), strict=False))

    @cached_property
    def _names(self) -> tuple[Contacts, ...]:
        """Sets by the names of their contacts."""
        return tuple(frozenset(contact_name(self.model.leg, link) for link in links) for links in self.sets)

    def advance(
        self, memory: Memory, readings: ContactReadings, expected: Collection[Contacts] = frozenset()
    ) -> Belief:
        """Take in readings of any number of samples, and decide after each whole block of 10 ms.

        Args:
            memory: Memory of the earlier samples, which this changes.
            readings: The next samples.
            expected: Sets of "left", "right" and "seat" that the function expects about now; empty if unknown.

        Returns:
            Probabilities after each block that these samples complete.

        Raises:
            ExoidError: A reading is not finite.
        """
        if not all(np.isfinite(x).all() for x in readings[:5] if x is not None):
            raise BadArgumentError("a reading is not finite", remedy="hold the last torque, and damp")
        every = max(1, round(BLOCK * self.rate))
        ends = np.arange(every - 1 - memory.left, len(readings.q), every)
        memory.left = (memory.left + len(readings.q)) % every
        low, speed, change = self._filtered(memory, readings, ends)
        likelihood, wrenches, misfit = self._evidence(low, speed, change)
        joints = range(len(self.model.leg.joint_names))
        count, speeds = self._still(memory, readings)[ends], np.abs(speed[:, joints])
        moves = speeds.max(axis=1) > self.noise.moves
        unknown = np.where(np.arange(likelihood.shape[1]) == len(self.sets), 0.0, -40.0)
        switched = [link for link in self.feet if link in readings.switches]
        own = [self.feet.index(link) for link in switched]
        flags = np.array([readings.switches[link][ends] for link in switched], dtype=np.float64).T
        # whether each switched foot is in each set, half for the unknown, (F, H)
        members = np.array([[*(float(link in each) for each in self.sets), 0.5] for link in switched])
        probability = np.empty_like(likelihood)
        planned = [not expected or each in expected for each in self._names]
        surprise = np.where([*planned, not expected], 0.0, np.log(self.noise.surprise))
        for k in range(len(ends)):
            belief = self.changes @ memory.probability
            memory.misfit += BLOCK / self.noise.agrees * (misfit[k] - memory.misfit)  # jolts are short
            wrong = memory.misfit > self.noise.misfit
            memory.distrusted = self.noise.distrusted if wrong else max(memory.distrusted - BLOCK, 0.0)
            # a frozen encoder explains the rows by another set: only that it was constant in motion tells, and still is
            memory.pace = np.where(count[k, joints] < every, speeds[k], memory.pace)
            rests = np.full(count.shape[1], self.noise.freezes)  # the longest time without a change of a good sensor
            rests[joints] += memory.step / np.maximum(self.noise.slows * memory.pace, self.noise.creeps)
            memory.frozen = (count[k] >= rests * self.rate) & (memory.frozen | moves[k])
            if np.any(memory.frozen) or memory.distrusted > 0.0:
                likelihood[k] = unknown
            score = self.noise.temper * (likelihood[k] - likelihood[k].max()) + surprise
            if flags.size:
                weight = np.clip(1.5 - 4.0 * memory.disagreement[own], 0.0, 1.0)
                right = 1.0 - np.abs(members - flags[k, :, None])
                each = self.noise.switch * right + (1.0 - self.noise.switch) * (1.0 - right)
                mixed = weight[:, None] * each + 0.5 * (1.0 - weight[:, None])
                # readings of one delay are one piece of evidence
                score = score + np.log(mixed).sum(axis=0) * BLOCK / self.noise.late
            belief = belief * np.exp(score - score.max())
            memory.probability = probability[k] = belief / belief.sum()
            if flags.size:
                down = members @ memory.probability
                # 0.3 s: a switch that is 80 ms late stays below half weight, one that is stuck loses all of it
                memory.disagreement[own] += BLOCK / 0.3 * (np.abs(flags[k] - down) - memory.disagreement[own])
        return Belief(probability, wrenches[range(len(ends)), probability.argmax(axis=1)])

    @cached_property
    def changes(self) -> FloatArray:
        """Prior of transitions: contacts change one by one; the unknown is rare, (H, H), from column to row."""
        sets, p = self.sets, self.noise.change
        A = np.array([[p ** (1.5 * len(a ^ b) - 0.5 * (a != b)) for b in sets] for a in sets])
        A = np.pad(A, (0, 1), constant_values=p**2)
        A[-1, -1] = 0.5  # and it ends soon
        A[np.arange(len(sets)), np.arange(len(sets))] = 0.0
        A += np.diag(1.0 - A.sum(axis=0))
        return np.asarray(A)

    @cached_property
    def filters(self) -> tuple[FloatArray, ...]:
        """Low-pass (ω/(s + ω))³, and the same of the first and second derivative, as second-order sections."""
        omega, out = 2.0 * np.pi * self.cutoff, []
        for order in range(3):
            zpk = scipy.signal.bilinear_zpk(np.zeros(order), np.full(3, -omega), omega**3, self.rate)
            out.append(scipy.signal.zpk2sos(*zpk))
        return tuple(out)

    @cached_property
    def gains(self) -> FloatArray:
        """Standard deviation of filtered white noise and of its derivatives, (3,)."""
        impulse = np.eye(1, int(self.rate))[0]
        return np.array([np.linalg.norm(scipy.signal.sosfilt(sos, impulse)) for sos in self.filters])

    def _filtered(
        self, memory: Memory, readings: ContactReadings, ends: NDArray[np.intp]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Pass all channels through the low-pass: values, and derivatives of angles and rates, at the blocks' ends."""
        known = readings.known if readings.known is not None else np.zeros((len(readings.q), len(self.model.row_names)))
        angles = np.hstack([readings.q, readings.gyro])
        channels = (np.hstack([angles, readings.tau, readings.force, known]), angles, readings.q)
        if memory.channels is None:  # as if the machine had been at rest
            memory.channels = [
                scipy.signal.sosfilt_zi(sos)[:, :, None] * x[0] for sos, x in zip(self.filters, channels, strict=True)
            ]
        out = []
        for k, (sos, x) in enumerate(zip(self.filters, channels, strict=True)):
            y, memory.channels[k] = scipy.signal.sosfilt(sos, x, axis=0, zi=memory.channels[k])
            out.append(y[ends])
        return out[0], out[1], out[2]

    def amend(self, memory: Memory, missed: FloatArray) -> None:
        """Add to the low-passes what angles and rates that froze have missed, (n + 3,), as if it had grown steadily."""
        for sos, states in zip(self.filters, memory.channels or (), strict=False):
            for k in np.flatnonzero(missed[: states.shape[2]]):
                joint = k < len(self.model.leg.joint_names)
                count = 1 if memory.still is None else int(memory.still[k if joint else -1])
                grown = np.linspace(0.0, missed[k], count + 1)[1:]
                states[:, :, k] += scipy.signal.sosfilt(sos, grown, zi=np.zeros((len(sos), 2)))[1]

    def _still(self, memory: Memory, readings: ContactReadings) -> NDArray[np.intp]:
        """Samples for which each angle, torque and the gyroscope has not changed at all, at each sample, (N, C)."""
        spin = readings.gyro @ self.model.leg.plane.lateral  # all that a planar machine turns
        x = np.hstack([readings.q, readings.tau, spin[:, np.newaxis]])
        last = x[0] - 1.0 if memory.last is None else memory.last
        still = np.zeros(x.shape[1], dtype=np.intp) if memory.still is None else memory.still
        row = np.arange(1, len(x) + 1)[:, np.newaxis]
        change = np.abs(np.diff(x, axis=0, prepend=last[np.newaxis]))
        count = row - np.maximum.accumulate(np.where(change > 0.0, row, -still), axis=0)
        steps = np.where(change > 0.0, change, np.inf)[:, : readings.q.shape[1]].min(axis=0)
        memory.last, memory.still, memory.step = x[-1], count[-1], np.minimum(memory.step, steps)
        return np.asarray(count)

    def _evidence(
        self, low: FloatArray, speed: FloatArray, change: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Log-likelihood of each hypothesis, (K, H), wrenches of each set, (K, H, S, 3), misfit of the best, (K,)."""
        leg, noise = self.model.leg, self.noise
        n, b, K = len(leg.joint_names), leg.base_rows, len(low)
        q, gyro, tau, force, known = np.split(low, np.cumsum([n, 3, n, 3]), axis=1)
        v, a, turning = speed[:, :n], change, speed[:, n:]
        base = BaseKinematics(gyro, turning, force).moved(-self.imu_position)
        W = self.model.regressor(q, v, a, base)  # (K, b + n, P)
        e = W @ self.values - known
        e[:, b:] -= tau
        low_gain, _, second = self.gains
        acceleration = np.zeros(b + n)
        acceleration[:2] = (noise.acceleration * low_gain) ** 2
        acceleration[2] = (noise.gyro * self.gains[1]) ** 2
        acceleration[b:] = (noise.angle * second) ** 2
        M = leg.mass_matrix(q)
        size = np.array([noise.force] * 2 + [noise.moment] * (b + n - 2))
        S = np.einsum("kri,ij,ksj->krs", W, self.covariance, W) + np.einsum("kri,i,ksi->krs", M, acceleration, M)
        spread = size**2 + (noise.relative * e) ** 2
        spread[:, b:] += (noise.torque * low_gain) ** 2
        S[:, range(b + n), range(b + n)] += spread
        # columns Jᵀ P^½ of the wrench on each sole about its middle, (K, R, 3); a point has a small moment
        J = {link: self.axes[link] @ leg.frame_jacobian(q, link, sole.centre) for link, sole in self.soles.items()}
        columns = {link: np.swapaxes(each, 1, 2) * self.prior for link, each in J.items()}
        up = np.column_stack([base.specific_force @ leg.plane.forward, base.specific_force @ leg.plane.up])
        up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1.0)
        rates = np.column_stack([np.zeros((K, 2)), -gyro @ leg.plane.lateral, v])
        speeds = {}  # velocity of the middle of each sole in base axes beside that of the base [m/s], (K, 2)
        for link, each in J.items():  # its first columns turn sole axes into base axes
            speeds[link] = np.einsum("kji,kjr,kr->ki", each[:, :2, :2], each[:, :2], rates)
        likelihood, wrenches = np.empty((K, len(self.sets) + 1)), np.zeros((K, len(self.sets) + 1, len(self.soles), 3))
        least = np.full(K, np.inf)  # distance of the best set
        seat = self.model.leg.description.root_link
        for h, links in enumerate(self.sets):
            # a seat that is loaded slowly bears a quarter of its usual forces
            bear, grades = [link for link in self.soles if link in links], (0.25, 1.0) if seat in links else (1.0,)
            both = [self._bear(S, e, [columns[x] * (g if x == seat else 1.0) for x in bear]) for g in grades]
            y, distance, _ = both[-1]
            likelihood[:, h] = np.logaddexp.reduce([score for *_, score in both]) - np.log(len(both))
            least = np.minimum(least, distance)
            own = [k for k, link in enumerate(self.soles) if link in links]
            for one, other in combinations(bear, 2):
                apart = ((speeds[one] - speeds[other]) ** 2).sum(axis=1)  # whatever the velocity of the base is
                likelihood[:, h] -= np.minimum(0.5 * apart / noise.slide**2, 20.0)
            if own:
                each = y[..., 0].reshape(K, len(own), 3)
                wrenches[:, h, own] = each * self.prior
                for k, link in enumerate(bear):
                    force = np.einsum("kri,ki->kr", columns[link][:, :2], each[:, k])
                    # without 40 N at least, a function that expects the seat would be proof of it
                    likelihood[:, h] -= self._impossible(force, up, 40.0 if link == seat else 0.0)
        wide = np.diag(self.weight * np.repeat([1.0, 0.3], [2, b + n - 2]))
        *_, likelihood[:, -1] = self._bear(S, e, [np.tile(wide, (K, 1, 1))])
        return likelihood, wrenches, np.log1p(least / noise.freedom)

    def _bear(
        self, S: FloatArray, e: FloatArray, loads: Sequence[FloatArray]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Forces of contacts, (K, 3 S), distance of what they do not explain and log-likelihood, (K,)."""
        G = np.concatenate([np.zeros((*e.shape, 0)), *loads], axis=2)
        S = S + G @ np.swapaxes(G, 1, 2)
        x = np.linalg.solve(S, e[..., None])
        distance = (e * x[..., 0]).sum(axis=1)
        # Student's t of the distance, as jolts are no evidence
        score = -0.5 * (self.noise.freedom + e.shape[1]) * np.log1p(distance / self.noise.freedom)
        return np.swapaxes(G, 1, 2) @ x, distance, np.asarray(score - 0.5 * np.linalg.slogdet(S)[1])

    def _impossible(self, force: FloatArray, up: FloatArray, least: float) -> FloatArray:
        """Penalty of a force in base axes, (K, 2), below the least, or far outside the friction cone; up is (K, 2)."""
        normal = (force * up).sum(axis=1)
        along = np.abs(force[:, 0] * up[:, 1] - force[:, 1] * up[:, 0])
        beyond = along / self.noise.cone - normal + least
        return np.asarray(np.clip(beyond / (2.0 * self.noise.force) - 1.0, 0.0, 20.0))

    @cached_property
    def weight(self) -> float:
        """Weight of the machine [N], by the estimate where M is a parameter: links may weigh other than in the URDF."""
        known = dict(zip(self.model.names, self.values.tolist(), strict=True))
        return GRAVITY * float(known.get("M", sum(body.mass for body in self.model.leg.model.inertias)))

    @cached_property
    def prior(self) -> FloatArray:
        """Standard deviations of forward and upward force [N] and of the moment about the middle of a sole [N·m]."""
        half = max(0.5 * float(np.ptp(sole.points @ self.axes[link][0, :3])) for link, sole in self.soles.items())
        return np.array([0.2, 0.5, 0.5 * max(half, 0.01)]) * self.weight

    @cached_property
    def axes(self) -> dict[str, FloatArray]:
        """Forward, up and pitch of each sole, of a twist in the axes of its link, (3, 6)."""
        leg = self.model.leg
        return {link: held_directions(leg.model, leg.description, link, leg.plane)[[0, 2, 4]] for link in self.soles}
