"""Laws on the ground as controllers of the rig: contacts by switches and a motion, or told and coordinated."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.control.functions import (
    FUNCTIONS,
    PHASE,
    SEAT,
    SIDES,
    Body,
    Contacts,
    contact_name,
    joint_angles,
    legs_flexion,
    minimum_jerk,
)
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import GroundMotion, GroundReading, Sole
from exoid.rig.ground.plant import SEAT as SEAT_SOLE
from exoid.rig.ground.plant import soles_of

from .coordination_in_c import coordinated_in_c
from .coordinator import DAMPING, KEEPS, SAFE, Coordinator, Decision
from .hypotheses import BLOCK, ContactFilter, ContactReadings
from .law import ContactKind, GroundState, GroundTarget, StanceCommand, StanceLaw, stance
from .model import BASE, BRAKE

BOUNCE = 0.02
"""Time for which an open switch still counts as closed, and then time in which the foot loses its share [s]."""

ROLLS, NOTICED = 0.06, 0.004
"""Velocity of a sole at rest [m/s], and slip from which the ground is slippery and a seat is not left [m]."""

TOLD = 0.1
"""Least change of an angle or a place of soles by which they tell a reading that froze [rad/rad or m/rad]."""


@dataclass(eq=False)
class LawLoop:
    """What every loop does with a law: it supports by the soles that have a share, and notes what the law wanted."""

    law: StanceLaw  # the law
    lean: float = field(default=0.0, kw_only=True)  # angle by which the ground rises forward [rad]
    commands: list[StanceCommand | None] = field(default_factory=list, kw_only=True)  # None where nothing bore
    state: GroundState | None = field(default=None, kw_only=True)  # state at the last sample

    def supported(
        self,
        reading: GroundReading,
        shares: Mapping[str, float],
        target: GroundTarget,
        plan: FloatArray | None,
        interaction: FloatArray | None = None,
    ) -> FloatArray | None:
        """Torque by the soles with a share, None without any; one that is tilted, or is to be, bears by heel or toe."""
        contacts: dict[str, ContactKind] = {}
        for link in shares:
            turns = np.append(self.law.model.turns[link], 1.0)
            tilt = float(turns @ np.append(reading.q, reading.pitch)) - self.lean
            planned = 0.0 if plan is None else float(turns @ plan) - self.lean
            # a sole that is to turn about its toe must not be held: the machine would work against itself. One that is
            # tilted by up to 0.05 rad presses both its ends down
            tilt, level = (planned, 0.01) if abs(planned) > 0.01 else (tilt, 0.05)
            contacts[link] = "flat" if abs(tilt) < level else "heel" if tilt > 0.0 else "toe"
        pose = reading.q, reading.v, reading.pitch, reading.pitch_rate
        self.state = GroundState(*pose, contacts, shares, interaction, reading.push, self.lean)
        command = self.law.command(self.state, target) if contacts else None
        self.commands.append(command)
        return None if command is None else command.torque


@dataclass(eq=False)
class GroundLoop(LawLoop):
    """Controller of :func:`exoid.rig.ground.simulate_on_ground` made of a law, with a memory: one for each run.

    Contacts are those of the switches, but a foot whose planned share is zero is in the air, and a level one is flat.
    A foot that touches down takes its share in 0.15 s, an assumption. As feet bounce, an open switch counts as closed
    for :data:`BOUNCE`, and its foot loses the share in as much time. While nothing touches, the joints are braked.

    Attributes:
        law: The law.
        motion: Reference of joints and torso.
        shares: Planned shares at a time, by the link of the sole; one that is not named has the
            share 1. None for equal shares.
        lean: Angle by which the ground rises forward [rad], for contacts that are not flat.
        commands: What the law wanted at each sample, None where nothing touched.
        state: State at the last sample.
    """

    motion: GroundMotion
    shares: Callable[[float], Mapping[str, float]] | None = None

    def __post_init__(self) -> None:
        """Interpolate the reference."""
        reference = np.column_stack([self.motion.q, self.motion.base[:, 2]])
        self._reference = scipy.interpolate.CubicSpline(self.motion.time, reference)
        self._closed: dict[str, float] = {}  # when a switch of each sole was closed last [s]
        self._course: dict[str, float] = {}  # course of the share of each sole, 0 to 1
        self._last = -np.inf  # time of the last sample [s]

    def target(self, time: float) -> GroundTarget:
        """Return the reference at a time.

        Args:
            time: Time [s].

        Returns:
            Joints and pitch with their derivatives.
        """
        return _target(*(self._reference(time, k) for k in range(3)))

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque to hold until the next sample.

        Args:
            reading: Readings of the rig.

        Returns:
            Torque [N·m], (n,).
        """
        planned = {} if self.shares is None else self.shares(reading.time)
        dt, self._last = reading.time - self._last, reading.time
        if unknown := planned.keys() - self.law.model.soles.keys():
            raise BadArgumentError(f"shares of {unknown}", remedy=f"name {', '.join(self.law.model.soles)}")
        shares = {}
        self._closed |= {link: reading.time for link, closed in reading.switches.items() if closed.any()}
        for link, closed in self._closed.items():
            course = self._course.get(link, 0.0) + dt / (0.15 if reading.time - closed < BOUNCE else -BOUNCE)
            self._course[link] = course = min(max(course, 0.0), 1.0) if planned.get(link, 1.0) > 0.0 else 0.0
            if course > 0.0:
                shares[link] = planned.get(link, 1.0) * float(minimum_jerk(course))
        target = self.target(reading.time)
        torque = self.supported(reading, shares, target, np.append(target.q, target.pitch))
        return -BRAKE * reading.v if torque is None else torque


@dataclass(eq=False)
class CoordinatedLoop(LawLoop):
    """Controller of :func:`exoid.rig.ground.simulate_on_ground` that needs no switches, with a memory: one for a run.

    Readings feed the filter, whose probabilities feed the coordinator. Its decision chooses the function, whose
    reference the law follows, and the shares. Torque is within the coordinator's bounds; without support joints are
    damped. Of the actuators the filter reads what the loop commanded. Push and interaction are measured. A sole that
    moves against the accelerometer's velocity slips: the law may then use less friction than it needed there. Where
    it slips on, or the machine is far from its reference, the footing is lost: the coordinator damps and stops.

    Attributes:
        law: The law.
        contacts: Filter of contacts, whose IMU is at the origin of the root link.
        coordinator: Coordinator; rates of controller, filter and coordinator are the same.
        requests: Function that the wearer asks for, by time [s].
        start: Function at whose end the run begins, at rest on its contacts; :data:`SAFE` for unknown contacts.
        lean: Angle by which the ground rises forward [rad], for contacts that are not flat.
        commands: What the law wanted at each sample, None where nothing bore load.
        decisions: Decision at each sample.
        state: State at the last sample.

    Raises:
        ExoidError: The rates are not the same, there is no such function, or the filter's IMU is elsewhere.
    """

    contacts: ContactFilter
    coordinator: Coordinator
    requests: Mapping[float, str] = field(default_factory=dict)
    start: str = "stand"
    decisions: list[Decision] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin on the last contacts of the first function."""
        leg, rate = self.law.model.leg, self.coordinator.rate
        if self.contacts.rate != rate:
            what = f"a filter at {self.contacts.rate:g} Hz for a coordinator at {rate:g} Hz"
            raise BadArgumentError(what, remedy="give both one rate")
        unknown, place = {*self.requests.values()} - {*self.coordinator.functions}, self.contacts.imu_position
        if unknown or place.any():
            raise BadArgumentError(f"requests of {unknown}, an IMU at {place} m", remedy="request functions, IMU at 0")
        self._links = {contact_name(leg, link): link for link in self.contacts.soles}
        self._memory = self.coordinator.begin(self.start, 1.0)
        known = None if self.start == SAFE else [self._links[name] for name in self._memory.known]
        self._told = self.contacts.begin(known)
        self._chances = self.contacts.chances(self._told.probability)
        self._wrench = np.zeros((len(self._links), 3))  # of each sole, at the last block
        self._waiting: list[tuple[FloatArray, ...]] = []  # samples since the last block
        self._requests = sorted(self.requests.items(), reverse=True)
        self._curves = {}
        for name, each in self.coordinator.functions.items():
            reference = np.column_stack([joint_angles(leg, each.flexion), each.torso[:, 2]])
            self._curves[name] = scipy.interpolate.CubicSpline(PHASE, reference)
        self._x: FloatArray | None = None  # last reference of joints and pitch
        self._off = np.zeros(self.law.model.n + 1)  # distance from the function when it began, or a foot landed
        self._since = np.zeros(self.law.model.n + 1)  # time since then [s]
        self._bears: Contacts = self._memory.known  # contacts that bore at the last sample
        self._late = dict.fromkeys(SIDES, 0.0)  # time for which a planned foot has not borne [s]
        self._speed = 0.0  # of the torso along the ground [m/s]
        self._slipped: dict[str, float] = {}  # way of each sole that bears [m]
        self._held: tuple[FloatArray, FloatArray] | None = None  # torque and posture of the last support
        self._beside = 0.0  # mean error of what the soles bear, beside what the law wants, over the weight
        self._grip = self.law.ground_friction  # coefficient of friction before any slip
        self._plan = np.zeros((2, self.law.model.n))  # angles and rates of the last target; later what they become
        self._frozen: dict[int, float] = {}  # readings of joints and of the pitch, last, that froze, and their values
        # angles and contacts of the last 2 s, and soles that bear since before a reading froze, with their places
        self._past: deque[tuple[FloatArray, Mapping[str, ContactKind]]] = deque(maxlen=round(2.0 * rate))
        self._apart: tuple[dict[str, ContactKind], FloatArray] = {}, np.zeros(0)

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque to hold until the next sample.

        Args:
            reading: Readings of the rig.

        Returns:
            Torque within the bounds [N·m], (n,).
        """
        reading, blind = self._mend(reading)
        self._tell(reading)
        if blind:  # a frozen reading that nothing replaces would make the filter certain of another set
            self._chances = dict.fromkeys(self._chances, 0.0)
        request = self._requests.pop()[1] if self._requests and reading.time >= self._requests[-1][0] else None
        request = None if self._frozen else request
        flexion = legs_flexion(self.law.model.leg, reading.q[np.newaxis])[0]
        before = self._memory.function, self._memory.phase
        lost, broken = self._lost(reading), bool(self._frozen)
        decision = self.coordinator.decide(self._memory, self._chances, flexion, request, lost=lost, broken=broken)
        self.decisions.append(decision)
        shares = {self._links[name]: share for name, share in decision.shares.items() if share > 0.0}
        target, plan = self._follow(*before, reading, frozenset(decision.shares))
        moves = [k for k in range(self.law.model.n) if k not in self._frozen]
        self._plan[:, moves] = np.array(target[:2])[:, moves]
        torque = self.supported(reading, shares, target, plan, reading.interaction)
        self._watch(reading, {} if torque is None or self.state is None else self.state.contacts)
        wanted = self._hold(reading) if torque is None else torque
        if self._memory.torque is None:
            self._memory.torque = wanted  # brakes hold the machine until then
        given = self.coordinator.bound(self._memory, wanted, reading.v)
        self._held = self._held if torque is None else (given, reading.q)
        return given

    @classmethod
    def of(
        cls,
        estimate: Estimate,
        soles: Mapping[str, Sole] | None = None,
        *,
        limit: ArrayLike | None = None,
        rate: float = 500.0,
    ) -> CoordinatedLoop:
        """Make law, filter and coordinator of an estimate, for all functions of a wearer of the machine's lengths.

        Args:
            estimate: Estimate of a planar machine of two legs with a floating base.
            soles: Soles of the feet, see :func:`exoid.control.stance`, and of the root link for a seat; None for the
                built-in machines, with a seat.
            limit: Largest torque [N·m], a number or (n,); None for the limits of the URDF.
            rate: Rate of all parts [Hz].

        Returns:
            The loop, at rest on both feet.

        Raises:
            ExoidError: As for :func:`exoid.control.stance` and :meth:`ContactFilter.of`, or the legs have no functions.

        Example:
            >>> from exoid.experiments import ground
            >>> log = ground.squats_and_shifts(ground.bleex_machine(), 2.0).recording()
            >>> loop = CoordinatedLoop.of(exoid.identify(exoid.load_exo("bleex", base="floating"), log, check=False))
            >>> loop.coordinator.states[:3]
            ('stand', 'sit', 'rise')
        """
        seat = {estimate.leg.description.root_link: SEAT_SOLE}
        own = {**soles_of(estimate.leg, None), **seat} if soles is None else soles
        law, body = stance(estimate, own, limit=limit, rate=rate), Body.of(estimate.leg, own)
        functions = {name: make(body) for name, make in FUNCTIONS.items()}
        contacts = ContactFilter.of(estimate, own, rate=rate)
        return cls(law, contacts, Coordinator(functions, law.limit, rate=rate))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe filter, coordinator and law in C: readings become contacts, function, shares and torque.

        The caller gives the reference for function and phase of the last step, and says where the footing is lost
        (``slips``) or a reading is made up (``broken``). While a reading is frozen, contacts are unknown.

        Args:
            dialect: Double precision.

        Returns:
            Description of inputs, tables and memory. It begins in the safe stop, whatever ``start`` is.

        Raises:
            ExoidError: The precision is single, law and filter have other soles, or a term has no form in C.
        """
        return coordinated_in_c(self.law, self.contacts, self.coordinator, dialect)

    def _hold(self, reading: GroundReading) -> FloatArray:
        """Torque without support: stiffly about the last posture with it; of damping where the footing was lost."""
        if self._held is None or self._memory.fell:
            return -DAMPING * reading.v
        (torque, q), known = self._held, self._memory.known
        # a joint whose reading froze has no error and no speed: it keeps its torque, but not in a leg in the air
        limbs, frozen = self.law.model.leg.limbs, np.isin(np.arange(len(q)), [*self._frozen])
        bears = np.repeat([limb.label in known for limb in limbs], [limb.chain.n for limb in limbs])
        stiff = self.coordinator.limit / 0.3  # an error of 0.3 rad has all of the torque
        return np.where(frozen, bears * torque, torque + stiff * (q - reading.q - 0.05 * reading.v))

    def _mend(self, reading: GroundReading) -> tuple[GroundReading, bool]:
        """Replace readings that froze by what soles at rest tell, and tell whether any is left."""
        turns, n, raw = self.law.model.turns, self.law.model.n, np.append(reading.q, reading.pitch)
        flags = np.resize(self._told.frozen, 2 * n + 1)[[*range(n), -1]]  # of angles and the gyroscope
        before, found = self._frozen, dict.fromkeys(np.flatnonzero(flags).tolist(), np.nan) | self._frozen
        self._frozen = {k: raw[k] for k, x in found.items() if raw[k] == x or np.isnan(x)}
        self._past.append((raw.copy(), {} if self.state is None else self.state.contacts))
        # a reading that froze a moment ago looks like a slip, and support may have ended
        recent = islice(reversed(self._past), round(KEEPS * self.coordinator.rate))
        contacts = next((each for _, each in recent if each), dict[str, ContactKind]())
        if new := self._frozen.keys() - before.keys():  # until now soles seemed to slip
            self._slipped, self._memory.lost, self._memory.fell = {}, 0.0, False
            self.law = replace(self.law, ground_friction=self._grip)
            same = np.array([[x[k] == raw[k] for x, _ in reversed(self._past)] for k in new])
            then, bore = self._past[-np.logical_and.accumulate(same, axis=1).sum(axis=1).max()]
            kinds = {x: kind for x, kind in contacts.items() if x in bore and x in self.contacts.feet}
            self._apart = kinds, self._between(then, kinds)[0]
        if not self._frozen:
            return reading, False
        # a flat sole is parallel to the ground, turns · q + pitch = lean
        flat = [x for x, kind in contacts.items() if kind == "flat" and self.law.model.places[x][1] > 0.0]
        level = np.reshape([np.append(turns[x], 1.0) for x in flat], (-1, n + 1))
        aloft = [k for k in self._frozen if k < n and not any(turns[x][k] for x in contacts)]
        lost, rates = [k for k in self._frozen if k not in aloft], np.append(reading.v, reading.pitch_rate)
        # a joint in the air moves about as the law wants
        wanted = self.commands[-1] if self.commands else None
        if wanted is not None:
            self._plan[1, aloft] += wanted.acceleration[BASE:][aloft] / self.coordinator.rate
        self._plan[0, aloft] += self._plan[1, aloft] / self.coordinator.rate
        raw[aloft], rates[aloft] = self._plan[:, aloft]
        kinds, apart = self._apart
        closes = np.linalg.matrix_rank(level[:, lost], TOLD) < len(lost) and kinds.keys() <= contacts.keys()
        for _ in range(3 if closes else 1):  # Newton's method
            A, error = level, level @ raw - self.lean
            if closes:  # soles that bear since before the reading froze keep their places beside each other
                places, J = self._between(raw, kinds)
                A, error = np.vstack([level, J]), np.append(error, places - apart)
            if np.linalg.matrix_rank(A[:, lost], TOLD) < len(lost):
                return reading, True
            raw[lost] -= np.linalg.lstsq(A[:, lost], error)[0]
        rates[lost] -= np.linalg.lstsq(A[:, lost], A @ rates)[0]
        if new:  # until now the filter saw no motion
            spin = -(rates[-1] - reading.pitch_rate) * self.law.model.leg.plane.lateral
            self.contacts.amend(self._told, np.append(raw[:-1] - reading.q, spin))
        return reading._replace(q=raw[:-1], v=rates[:-1], pitch=float(raw[-1]), pitch_rate=float(rates[-1])), False

    def _between(self, x: FloatArray, kinds: Mapping[str, ContactKind]) -> tuple[FloatArray, FloatArray]:
        """Places of soles beside the first one [m], along and across the ground, and their derivative by x."""
        model, pose = self.law.model, (x[:-1], 0.0 * x[:-1], float(x[-1]), 0.0)
        model.dynamics(*pose)
        # any point of a flat sole is at rest, such as its toe
        ends = [model.contact(y, "toe" if kinds[y] == "flat" else kinds[y], pose, (1.0, 0.0, self.lean)) for y in kinds]
        J = [np.roll(end.J[:, BASE - 1 :] - ends[0].J[:, BASE - 1 :], -1, axis=1) for end in ends[1:]]
        return np.ravel([end.place - ends[0].place for end in ends[1:]]), np.reshape(J, (-1, len(x)))

    def _tell(self, reading: GroundReading) -> None:
        """Feed the filter, in whole blocks, with the torque that acted until now."""
        if self._memory.torque is None:
            return
        gyro = -reading.pitch_rate * self.law.model.leg.plane.lateral
        known = np.concatenate([reading.push, reading.interaction])
        self._waiting.append((reading.q, self._memory.torque, gyro, reading.specific_force, known))
        if len(self._waiting) >= round(BLOCK * self.contacts.rate):
            q, tau, rates, force, measured = (np.array(x) for x in zip(*self._waiting, strict=True))
            block = ContactReadings(q, tau, rates, force, measured)
            belief = self.contacts.advance(self._told, block, self.coordinator.expected(self._memory))
            self._chances = self.contacts.chances(belief.probability[-1])
            self._wrench = belief.wrench[-1]
            self._waiting.clear()

    def _watch(self, reading: GroundReading, contacts: Mapping[str, ContactKind]) -> None:
        """Take in how fast the soles that bear move by the accelerometer, and how much friction they had."""
        model, dt, angle = self.law.model, 1.0 / self.coordinator.rate, reading.pitch - self.lean
        axes = model.leg.plane.forward + 1j * model.leg.plane.up  # a vector (forward, up) is a complex number
        hip = axes @ model.leg.hip
        rates = np.append(reading.pitch_rate * np.array([-hip.imag, hip.real, 1.0]), reading.v)
        pose = reading.q, reading.v, reading.pitch, reading.pitch_rate
        speeds = {
            link: float(model.contact(link, kind, pose, (1.0, 0.0, self.lean)).J[0] @ rates)
            for link, kind in contacts.items()
            if link in self.contacts.feet  # a seat may slide
        }
        pull = float((np.exp(1j * angle) * (axes @ reading.specific_force)).real) - GRAVITY * np.sin(self.lean)
        self._speed = self._speed + dt * pull if self._slipped or not speeds else -float(np.mean([*speeds.values()]))
        speeds = {link: self._speed + speed for link, speed in speeds.items()}
        self._slipped = {
            link: max(self._slipped.get(link, 0.0) + dt * (abs(speed) - ROLLS), 0.0) for link, speed in speeds.items()
        }
        # the accelerometer tells a velocity for 0.5 s
        self._speed -= dt / 0.5 * float(np.mean([*speeds.values()])) if speeds else 0.0
        beside, command = 0.0, self.commands[-1]
        forces: Mapping[str, FloatArray] = {} if command is None else command.forces
        for link, (forward, up, _) in zip(self.contacts.soles, self._wrench, strict=True):
            force = (forward + 1j * up) * np.exp(1j * (angle + model.turns[link] @ reading.q))
            wanted = forces[link][1] if link in forces else 0.0
            beside += abs(force.imag - wanted) / self.law.weight if forces else 0.0
            ratio, least = abs(force.real) / max(force.imag, 1.0), max(0.08, 1.5 * abs(np.tan(self.lean)))
            # a sole that is set down seems to slide a little, with a force that any ground bears
            if self._slipped.get(link, 0.0) > NOTICED and abs(speeds[link]) > ROLLS and ratio > least:
                self.law = replace(self.law, ground_friction=min(self.law.ground_friction, float(0.7 * ratio)))
        self._beside += dt / 1.2 * (beside - self._beside)  # a mean over 1.2 s: loads of a step differ for less

    def _lost(self, reading: GroundReading) -> bool:
        """Whether a sole slips on, or at all before a seat, or posture or loads are far from what is wanted."""
        far = 0.0 if self._x is None else float(np.abs(np.append(reading.q, reading.pitch) - self._x).max())
        unlike = self._beside > 0.4 and far > 0.02  # how feet share a load in a posture that holds is no loss
        slips = max(self._slipped.values(), default=0.0) > (NOTICED if SEAT in self._memory.known else 0.03)
        return far > 0.45 or unlike or slips

    def _follow(
        self, function: str, phase: float, reading: GroundReading, bears: Contacts
    ) -> tuple[GroundTarget, FloatArray | None]:
        """Reference of the function that runs, given the last, and its plan; the safe stop, without one, stays."""
        now, dt, q = self._memory, 1.0 / self.coordinator.rate, reading.q
        lands, self._bears = bears - self._bears, bears
        curve = self._curves.get(now.function)
        if curve is None:
            still = np.zeros(self.law.model.n + 1)
            self._off[:] = self._since[:] = 0.0
            if self._x is None or (now.fell and not bears):
                self._x = np.append(q, reading.pitch)
            return _target(self._x, still, still), None
        x, slope, bend = (curve(now.phase, k) for k in range(3))
        rate = (now.phase - phase) / dt
        if now.function != function:
            rate, self._since[:] = 0.0, 0.0
            self._off[:] = 0.0 if self._x is None else self._x - x
        elif rate < 0.0:
            rate += 1.0 / dt  # of a cyclic function
        late = self.coordinator.functions[now.function].expected(now.phase) - bears
        lower, speed = np.zeros(len(x)), slope * rate
        for limb in self.law.model.leg.limbs:
            own, side = limb.joints, limb.label
            if side in lands:  # early or late: it stays where it is, or both legs would press against each other
                self._since[own], self._off[own] = 0.0, q[own] - x[own]
            self._late[side] = min(self._late[side] + dt, 0.3) * (side in late)
            if side in late:  # it is lowered at 0.3 m/s, for 0.3 s
                speed[own] += (way := 0.3 * self._lowering(q, side, own))
                lower[own] = self._late[side] * way
        self._since += dt
        self._x = x + self._off * (1.0 - minimum_jerk(self._since / 0.5))  # half a second from one function to the next
        # soles turn as the function plans: the reference that meets a foot where it landed has an error of the pitch
        return _target(self._x + lower, speed, bend * rate**2), x

    def _lowering(self, q: FloatArray, side: str, joints: slice) -> FloatArray:
        """Change of the angles of a leg that lowers its sole by 1 m, parallel to itself if it has an ankle."""
        leg, link = self.law.model.leg, self._links[side]
        J = leg.frame_jacobian(q[np.newaxis], link, self.contacts.soles[link].centre)[0, :, leg.base_rows :][:, joints]
        rows = (self.contacts.axes[link][[1, 0, 2]] @ J)[: J.shape[1]]
        return np.asarray(np.linalg.lstsq(rows, -np.eye(len(rows))[0])[0])


def _target(x: FloatArray, v: FloatArray, a: FloatArray) -> GroundTarget:
    """Target of joints and pitch, which is last."""
    return GroundTarget(x[:-1], v[:-1], a[:-1], x[-1], v[-1], a[-1])
