"""Coordination of functions: a checked state machine as a table, support by known contacts, bounded torque."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.functions import PHASE, SEAT, SIDES, Contacts, Function, minimum_jerk
from exoid.control.limited import bounded
from exoid.errors import BadArgumentError, nearest
from exoid.tools.numbers import checked

from .hypotheses import CERTAIN

SAFE = "safe stop"
"""State of the fall-back: support as long as contacts are known, then damping."""

RESTS = 0.3
"""Time for which contacts must be known before the safe stop ends, or joints are damped without a footing [s]."""

RISES, JERKS, DAMPING = 0.08, 0.01, 8.0
"""Times in which the torque may cross its range and reach this rate [s], and damping of the fall-back [N·m·s/rad]."""

KEEPS, TRANSFER = 0.15, 0.1
"""Times for which the last support is kept in doubt, and in which a foot takes its share [s]."""


class Rule(NamedTuple):
    """Row of the table: in a function, a condition leads to another function.

    Attributes:
        function: Function that runs.
        condition: "request" of the wearer for the other function, "end" of this one, or "known": contacts and posture
            are those at which it begins. Out of :data:`SAFE` any request leads to its nearest phase on these contacts.
        then: Function that follows.
    """

    function: str
    condition: str
    then: str


TABLE = (
    *(Rule("stand", "request", name) for name in ("sit", "walk", "stairs up", "stairs down", "slope")),
    Rule("sit", "request", "rise"),
    Rule("rise", "end", "stand"),
    *(Rule(name, "request", "stand") for name in ("walk", "stairs up", "stairs down", "slope")),
    Rule(SAFE, "known", "stand"),
    Rule(SAFE, "known", "sit"),
    Rule(SAFE, "request", "rise"),
)
"""The usual table. Every function has one more rule, to :data:`SAFE`, where contacts stay unknown or unexpected."""


class Decision(NamedTuple):
    """What the coordinator decided at a sample.

    Attributes:
        function: Function that runs, or :data:`SAFE`.
        phase: Its phase.
        level: "support", "frozen" (support of the last known contacts, shares frozen) or "damping".
        shares: Share of the load of each foot, and of a seat, that the law may use; empty for damping.
    """

    function: str
    phase: float
    level: str
    shares: Mapping[str, float]


@dataclass
class CoordinatorMemory:
    """What the coordinator keeps between samples."""

    function: str
    phase: float = 0.0
    known: Contacts = frozenset()  # contacts when they were last known
    since_known: float = 0.0  # time since then, or since the beginning [s]
    unexpected: float = 0.0  # time for which contacts were not those of the function [s]
    settled: float = 0.0  # time for which contacts have been known without a change [s]
    lost: float = 0.0  # time for which joints are still damped after the footing was lost [s]
    fell: bool = False  # whether the safe stop follows a loss of footing: it ends by a request only
    request: str | None = None
    waiting: float = 0.0  # time since the request [s]
    loaded: dict[str, float] = field(default_factory=dict)  # course of the share of each contact, 0 to 1
    torque: FloatArray | None = None  # last torque [N·m], (n,)
    slope: FloatArray | float = 0.0  # its rate [N·m/s], (n,)


@dataclass(frozen=True, eq=False, repr=False)
class Coordinator:
    """Decides which function runs and which contacts a law may use, and bounds torque, its power, rate and jerk.

    Attributes:
        functions: Functions by name, see :data:`exoid.control.functions.FUNCTIONS`.
        limit: Largest torque of each joint [N·m], (n,).
        table: Rules of the state machine.
        power: Largest power of a joint [W].
        patience: Time after which a request that cannot be granted is dropped, and after which contacts that the
            function does not expect lead to :data:`SAFE` [s].
        rate: Rate of the decisions [Hz].

    Raises:
        ExoidError: The table names an unknown function, a state has no exit or no way to "stand", a function that ends
            leads to one with other contacts, or a number is not positive.
    """

    functions: Mapping[str, Function]
    limit: FloatArray
    table: Sequence[Rule] = TABLE
    power: float = 500.0
    patience: float = 1.5
    rate: float = 1000.0

    def __post_init__(self) -> None:
        """Check numbers and table."""
        checked([self.patience, self.power, self.rate], "numbers of a coordinator", above=0.0)
        checked(self.limit, "the limits of a coordinator [N·m]", above=0.0)
        _check_table(self.functions, self.table)

    def begin(self, function: str = "stand", phase: float = 0.0) -> CoordinatorMemory:
        """Make the memory before the first sample.

        Args:
            function: Function that runs.
            phase: Its phase.

        Returns:
            The memory.

        Raises:
            ExoidError: There is no such function.
        """
        if function not in self.states:
            raise BadArgumentError(f"no function {function!r}", remedy=f"use one of {', '.join(self.functions)}")
        known = frozenset(SIDES) if function == SAFE else self.functions[function].expected(phase)
        return CoordinatorMemory(function, phase, known, loaded=dict.fromkeys(known, 1.0))

    def decide(
        self,
        memory: CoordinatorMemory,
        probability: Mapping[Contacts, float],
        flexion: FloatArray,
        request: str | None = None,
        *,
        lost: bool = False,
        broken: bool = False,
    ) -> Decision:
        """Decide at a sample.

        Args:
            memory: Memory, which this changes.
            probability: Probability of each set of contacts ("left", "right", "seat"); the rest is unknown.
            flexion: Flexion of both legs [rad], (2, 3).
            request: Function that the wearer asks for; None for nothing new.
            lost: Whether the footing is lost, so that joints are damped and :data:`SAFE` follows.
            broken: Whether a reading is made up from others: :data:`SAFE` follows where the function would lift a
                foot; it has support, and lasts until the reading is back.

        Returns:
            The decision.

        Raises:
            ExoidError: There is no such function, or a number is missing or impossible.
        """
        if request is not None and request not in self.functions:
            remedy = f"{nearest(request, self.functions)}use one of {', '.join(self.functions)}"
            raise BadArgumentError(f"no function {request!r}", remedy=remedy)
        chances = [0.0, *probability.values()]
        if not (min(chances) >= 0.0 and sum(chances) < 1.0 + 1e-6 and np.isfinite(flexion).all()):
            what = f"probabilities {chances[1:]} of contacts, flexion {np.ravel(flexion)}"
            raise BadArgumentError(what, remedy="give finite angles, and probabilities with a sum of one at most")
        dt, best = 1.0 / self.rate, max(probability, key=lambda each: probability[each], default=frozenset[str]())
        known = probability.get(best, 0.0) > CERTAIN
        memory.settled = memory.settled + dt if known and best == memory.known else 0.0
        memory.known, memory.since_known = (best, 0.0) if known else (memory.known, memory.since_known + dt)
        memory.lost, memory.fell = RESTS if lost else memory.lost, memory.fell or lost
        if lost or broken:
            # with a made-up reading no foot leaves the ground: what keeps both there comes to its end
            memory.settled, runs = 0.0, self.functions.get(memory.function)
            if lost or runs is None or any({*SIDES} - each for _, each in runs.contacts):
                self._enter(memory, SAFE)
        self._advance(memory, best if known else None, flexion, request, dt)
        memory.lost = max(memory.lost - dt, 0.0)
        # a leg that may be in the air bears nothing, whatever the last state was
        held = memory.since_known < KEEPS
        doubt = held and not known
        total = max(sum(probability.values()), 1e-99) if doubt else 1.0  # a jolt makes all sets less probable alike
        bears = {name: sum(p for each, p in probability.items() if name in each) / total for name in (*SIDES, SEAT)}
        planned, leaving = memory.known, frozenset[str]()
        if memory.function != SAFE:
            function = self.functions[memory.function]
            planned = function.expected(memory.phase)
            leaving = memory.known - function.expected(memory.phase + TRANSFER / function.duration)
        kept = []
        for name in (*SIDES, SEAT):  # not in the order of a set, which varies
            proven = name in planned or memory.settled >= 0.1  # a foot planned in the air needs lasting proof [s]
            least = 0.9 if doubt and name in planned else CERTAIN
            if name in memory.known and proven and bears[name] >= least:
                kept.append(name)
        feet = [name for name in kept if name != SEAT]
        level = "damping" if memory.lost > 0.0 else "support" if known else "frozen" if held or feet else "damping"
        for name in (*SIDES, SEAT):  # what is left bears less and less in doubt, too
            way = -1.0 if name in leaving else 0.0 if level == "frozen" else 1.0
            # a foot that is felt and then bears next to nothing would be lost again
            course = max(memory.loaded.get(name, 0.0), 0.3 * (way > 0.0)) + way * dt / TRANSFER
            memory.loaded[name] = min(max(course, 0.0), 1.0) if name in kept and level != "damping" else 0.0
        if level == "damping" or not feet:
            return Decision(memory.function, memory.phase, "damping", {})
        shares = {name: float(minimum_jerk(memory.loaded[name])) for name in kept}
        if len(feet) == 1 and shares[feet[0]] <= 0.0:
            shares[feet[0]] = 1.0
        return Decision(memory.function, memory.phase, level, shares)

    def expected(self, memory: CoordinatorMemory) -> Collection[Contacts]:
        """List the sets of contacts that the function expects about now.

        Args:
            memory: Memory.

        Returns:
            Sets that it plans within 0.3 s, as a change may be early or late; none in the safe stop.
        """
        if memory.function == SAFE:
            return frozenset()
        function = self.functions[memory.function]
        return {function.expected(memory.phase + way / function.duration) for way in (-0.3, 0.0, 0.3)}

    def bound(self, memory: CoordinatorMemory, wanted: FloatArray, v: FloatArray) -> FloatArray:
        """Bound torque and power, and rate and jerk of the torque. Torque and power come before rate and jerk.

        Args:
            memory: Memory, which this changes.
            wanted: Torque that is wanted [N·m], (n,); zero for what is not finite.
            v: Joint velocities [rad/s], (n,).

        Returns:
            Torque within the bounds [N·m], (n,).
        """
        aim = np.nan_to_num(wanted, nan=0.0, posinf=0.0, neginf=0.0)
        most, fastest = np.fmin(self.limit, self.power / np.maximum(np.abs(v), 1e-6)), 2.0 * self.limit / RISES
        last, bounds = 0.0 if memory.torque is None else memory.torque, (most, fastest, 1.0 / self.rate)
        memory.torque, memory.slope = bounded(aim, last, *bounds, fastest / JERKS, memory.slope)
        return memory.torque

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the functions, and of the safe stop, which is last."""
        return (*self.functions, SAFE)

    @property
    def numbers(self) -> dict[str, float]:
        """Tuned numbers by their names in C."""
        own = {"certain": CERTAIN, "rests": RESTS, "keeps": KEEPS, "transfer": TRANSFER, "damping": DAMPING}
        return own | {"rises": RISES, "jerks": JERKS}

    def _advance(
        self, memory: CoordinatorMemory, contacts: Contacts | None, flexion: FloatArray, request: str | None, dt: float
    ) -> None:
        """Move the phase on, and follow the rules."""
        if request is not None:
            memory.request, memory.waiting = request, 0.0
        elif memory.request is not None:
            memory.waiting += dt
            stride = 0.0 if memory.function == SAFE else self.functions[memory.function].duration
            memory.request = memory.request if memory.waiting < max(self.patience, stride) else None
        if memory.function == SAFE:
            self._recover(memory, contacts, flexion)
            return
        function = self.functions[memory.function]
        expected = function.expected(memory.phase)
        soon = function.expected(memory.phase + 0.1)
        memory.unexpected = 0.0 if contacts in (expected, soon) else memory.unexpected + dt
        # the phase waits for a contact that is late, and hurries to one that came early
        bears = memory.since_known < KEEPS or any(memory.loaded.values())  # without a support it waits, too
        pace = float(bears) if contacts is None else 1.0 if contacts == expected else 1.5 if contacts == soon else 0.3
        memory.phase += pace * dt / function.duration
        memory.phase = memory.phase % 1.0 if function.cyclic else min(memory.phase, 1.0)
        if memory.unexpected > self.patience or memory.since_known > max(self.patience, KEEPS):
            self._enter(memory, SAFE)
            return
        for rule in self.table:
            if rule.function != memory.function or rule.then == SAFE:
                continue
            ended, then = memory.phase >= 1.0, self.functions[rule.then]
            asked = memory.request == rule.then and (function.cyclic or ended or memory.function == "stand")
            # a stride begins from standing on both feet
            begins = frozenset(SIDES) if then.cyclic else then.expected(0.0)
            may = asked if rule.condition == "request" else rule.condition == "end" and ended
            if may and contacts == begins and np.abs(then.flexion[0] - flexion).max() <= then.room:
                self._enter(memory, rule.then)
                return

    def _recover(self, memory: CoordinatorMemory, contacts: Contacts | None, flexion: FloatArray) -> None:
        """Leave the safe stop when contacts were known for long and belong to a function at rest."""
        memory.phase = 1.0
        if contacts is None or memory.settled < RESTS or (memory.fell and memory.request is None):
            return
        memory.fell = False
        for rule in self.table:
            then = self.functions.get(rule.then)
            if rule.function == SAFE and then and (rule.condition == "known" or memory.request):
                far = np.abs(then.flexion - flexion).max(axis=(1, 2))  # from the posture at each phase
                far[[then.expected(phase) != contacts for phase in PHASE]] = np.inf
                k = len(PHASE) - 1 if rule.condition == "known" else int(far.argmin())
                if far[k] <= then.room:
                    self._enter(memory, rule.then, float(PHASE[k]))
                    return

    @staticmethod
    def _enter(memory: CoordinatorMemory, function: str, phase: float = 0.0) -> None:
        memory.function, memory.phase, memory.unexpected, memory.request = function, phase, 0.0, None


def _check_table(functions: Mapping[str, Function], table: Sequence[Rule]) -> None:
    """Refuse a state machine with unknown names, a state without a way to stand, or a function in the air."""
    states = (*functions, SAFE)
    for rule in table:
        unknown = [name for name in (rule.function, rule.then) if name not in states]
        if unknown or rule.condition not in ("request", "end", "known"):
            what = f"the rule {rule.function} -> {rule.then} on {rule.condition!r}"
            remedy = f"functions are {', '.join(functions)}; conditions are request, end and known"
            raise BadArgumentError(what, remedy=remedy)
        if rule.condition == "end" and functions[rule.function].expected(1.0) != functions[rule.then].expected(0.0):
            what = f"{rule.function} ends on other contacts than those on which {rule.then} begins"
            raise BadArgumentError(what, remedy="put a function between them")
    for name in states:
        if not any(rule.function == name and rule.then != name for rule in table):
            raise BadArgumentError(f"the state {name!r} has no exit", remedy="add a rule that leads out of it")
        reached, new = {name}, {name}
        while new:
            new = {rule.then for rule in table if rule.function in reached} - reached
            reached |= new
        if "stand" not in reached:
            raise BadArgumentError(f"no way leads from {name!r} to 'stand'", remedy="add a rule")
    for name, function in functions.items():
        for start, contacts in function.contacts:
            if not contacts & {*SIDES}:
                raise BadArgumentError(
                    f"{name} has no foot on the ground from phase {start:.3g}",
                    remedy="no law supports a machine in the air; raise its feet less",
                )
