"""How contacts are told, and functions coordinated, over a day: modes, delays, switches, seat-off, faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray
from exoid.control.functions import FUNCTIONS, SEAT, SIDES, Body, contact_name, legs_flexion
from exoid.control.ground.coordinator import DAMPING, SAFE, Coordinator
from exoid.control.ground.hypotheses import BLOCK, Belief, ContactFilter, ContactReadings
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.identification import identify
from exoid.lab.reproduce.stance import TERMS
from exoid.rig.ground import GroundPlant, GroundSensors
from exoid.signals import Recording
from exoid.torques import Stiffness

from .day import MACHINES, Episode, run_day, run_function

AWAY = 0.1
"""Time from a transition from which a mode is judged [s]."""

SENSORS = GroundSensors(torque_noise=0.5)
"""Sensors of training and day."""


@dataclass(frozen=True)
class FunctionScore:
    """How contacts were told in the episodes of one function."""

    accuracy: float  # share of right modes among samples further than 100 ms from a transition
    samples: int  # number of these samples
    certain: float  # share of all samples in which a set of contacts has a probability above 0.99
    delay: float  # 95 % quantile of the delays of single contacts [s]
    transitions: int  # number of judged changes of single contacts


@dataclass(frozen=True, eq=False)
class EventScore:
    """What the coordinator did in random planted faults, on logs of the day."""

    cases: int
    beyond_limits: int  # cases with a torque beyond its limit or power
    in_air: int  # cases with support for more than 60 ms by a leg that was in the air
    ended: Mapping[str, int]  # cases by their end: "followed" or "safe stop"


@dataclass(frozen=True, eq=False)
class CoordinationStudy:
    """Day of a machine, and how its contacts and functions were told."""

    name: str
    plant: GroundPlant
    estimate: Estimate
    episodes: Sequence[Episode]
    beliefs: Sequence[Belief]
    functions: Mapping[str, FunctionScore]
    switches: Mapping[str, float]  # accuracy of modes by the state of the switches
    seat_off: Sequence[float]  # delay of each seat-off [s]
    events: EventScore
    seed: int

    @property
    def mode_accuracy(self) -> float:
        """Share of right modes among samples further than 100 ms from a transition."""
        each = self.functions.values()
        return sum(score.accuracy * score.samples for score in each) / sum(score.samples for score in each)


def coordinate(
    source: str | Estimate,
    *,
    seconds: float = 180.0,
    events: int = 40,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> CoordinationStudy:
    """Run a day on the virtual rig, and tell contacts and functions from the rows of the identified machine.

    For "bleex" and "cuhk" the machine is identified from a calibration with instrumented soles: a squat, a walk and a
    swing in the air. For an estimate, the rig has its parameters as drawn from its distribution.

    Args:
        source: "bleex", "cuhk", or an estimate of one of them with a floating base.
        seconds: Duration of the day [s].
        events: Number of planted faults.
        seed: Seed of motions, noise and faults.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        The study.

    Raises:
        ExoidError: MuJoCo is not installed, or the estimate is of another machine.
    """
    report = progress or (lambda _: None)
    plant, estimate, name = _machine(source, seed)
    report(0.1)
    episodes = run_day(plant, seconds, seed, lambda share: report(0.1 + 0.6 * share))
    runs = [episode.run for episode in episodes]
    logs = [  # crutches are measured, feet and seat are not
        run.recording(SENSORS, np.random.default_rng([seed, k, 300]), wrenches=(run.plant.root_link,))
        for k, run in enumerate(runs)
    ]
    filters = []
    for run in runs:
        rate = 1.0 / float(run.time[1] - run.time[0])
        filters.append(ContactFilter.of(estimate, run.plant.soles, SENSORS.imu_position, rate=rate))
    beliefs = [over(told, log) for told, log in zip(filters, logs, strict=True)]
    report(0.8)
    rng = np.random.default_rng([seed, 7])
    study = CoordinationStudy(
        name=name,
        plant=plant,
        estimate=estimate,
        episodes=episodes,
        beliefs=beliefs,
        functions=_scores(filters, episodes, beliefs),
        switches=_with_switches(filters, episodes, logs),
        seat_off=_seat_off(filters, episodes, beliefs),
        events=_plant_events(filters, episodes, logs, events, rng),
        seed=seed,
    )
    report(1.0)
    return study


def _machine(source: str | Estimate, seed: int) -> tuple[GroundPlant, Estimate, str]:
    """Machine on the rig, and its estimate."""
    if isinstance(source, str):
        if source not in MACHINES:
            raise BadArgumentError(f"no machine {source!r}", remedy=f"use {', '.join(MACHINES)} or an estimate file")
        plant = MACHINES[source]()
        return plant, calibrate(plant, seed), source
    joints = source.joint_names
    name = next((name for name, make in MACHINES.items() if make().leg.joint_names == joints), None)
    if name is None or source.leg.base != "floating":
        raise BadArgumentError(
            f"no rig for an estimate of {', '.join(joints)}",
            where=source.leg.description.name,
            remedy="give an estimate of both legs of bleex or cuhk with a floating base",
        )
    drawn = np.random.default_rng([seed, 5]).multivariate_normal(source.values, source.covariance)
    known = MACHINES[name]()
    values = known.values
    values |= {key: float(x) for key, x in zip(source.names, drawn, strict=True) if key in values}
    for key in values:
        if key.startswith(("c0_", "d_", "Ia_")):
            values[key] = max(values[key], 0.0)
    return GroundPlant.build(known.leg, known.soles, values), source, name


def calibrate(plant: GroundPlant, seed: int = 0) -> Estimate:
    """Identify a machine from a squat, a walk and a swing in the air, with instrumented soles.

    Args:
        plant: The machine.
        seed: Seed of motions and noise.

    Returns:
        The estimate, with friction and rotors.
    """
    logs = []
    for k, (name, seconds) in enumerate((("squat", 10.0), ("walk", 12.0), ("swing", 12.0))):
        run = run_function(plant, name, seconds, np.random.default_rng([seed, 100 + k])).run
        logs.append(replace(run.recording(SENSORS, np.random.default_rng([seed, 200 + k])), contacts={}))
    terms = (*TERMS, Stiffness()) if plant.stiffness.any() else TERMS
    found: Estimate = identify(plant.leg, logs, terms, check=False)
    return found


def readings_of(
    told: ContactFilter, log: Recording, switches: Mapping[str, BoolArray] | None = None
) -> ContactReadings:
    """Take the readings out of a log, with other switches than its own if they are given; crutches are known."""
    known = None
    for link, wrench in log.wrenches.items():
        J = told.model.leg.frame_jacobian(log.q, link, wrench.point)
        rows = np.einsum("ncr,nc->nr", J, np.hstack([wrench.force, wrench.moment]))
        known = rows if known is None else known + rows
    own = {link: log.contacts[link] for link in told.feet} if switches is None else switches
    assert log.tau is not None and log.base is not None  # of the rig  # noqa: PT018
    return ContactReadings(log.q, log.tau, log.base.angular_velocity, log.base.specific_force, known, own)


def over(told: ContactFilter, log: Recording, switches: Mapping[str, BoolArray] | None = None) -> Belief:
    """Run a filter over a log as on line, with other switches than the log's if they are given."""
    return told.advance(told.begin(), readings_of(told, log, switches))


def _blocks(told: ContactFilter, samples: int) -> NDArray[np.intp]:
    """Samples at which blocks end."""
    every = max(1, round(BLOCK * told.rate))
    return np.arange(every - 1, samples, every)


def _members(told: ContactFilter, episode: Episode) -> tuple[tuple[str, ...], BoolArray]:
    """Names of the contacts, and which are in each set; the unknown has none, (H, C)."""
    names = tuple(contact_name(episode.run.plant.leg, link) for link in told.soles)
    rows = [[link in each for link in told.soles] for each in told.sets]
    return names, np.array([*rows, [False] * len(names)])


def _judge(told: ContactFilter, episode: Episode, belief: Belief) -> tuple[BoolArray, BoolArray]:
    """Whether the most probable set is right after each block, and whether the block is far from a transition."""
    names, members = _members(told, episode)
    ends, truth, time = _blocks(told, len(episode.run.time)), episode.truth(), episode.run.time
    true = np.column_stack([truth[name] for name in names])
    best = belief.probability.argmax(axis=1)
    right = (members[best] == true[ends]).all(axis=1) & (best < len(told.sets))
    changes = time[1:][(true[1:] != true[:-1]).any(axis=1)]
    far = np.ones(len(ends), dtype=np.bool_)
    for change in changes:
        far &= np.abs(time[ends] - change) > AWAY
    return right, far


def _delays(told: ContactFilter, episode: Episode, belief: Belief, only: str | None = None) -> list[float]:
    """Time from each change of a contact that lasts 100 ms on both sides until it is told, and stays told."""
    names, members = _members(told, episode)
    ends, truth, time = _blocks(told, len(episode.run.time)), episode.truth(), episode.run.time
    at, out = time[ends], list[float]()
    for k, name in enumerate(names):
        if only is not None and name != only:
            continue
        said, true = members[belief.probability.argmax(axis=1), k], truth[name]
        changes = np.flatnonzero(true[1:] != true[:-1]) + 1
        for i, change in enumerate(changes):
            before = time[changes[i - 1]] if i else 0.0
            after = time[changes[i + 1]] if i + 1 < len(changes) else time[-1]
            start = time[change]
            if min(start - before, after - start) < AWAY:
                continue
            wrong = np.flatnonzero((at >= start) & (at < after) & (said != true[change]))
            # what is wrong later is no delay, and counts in the accuracy
            runs = np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1)
            late = len(wrong) > 0 and at[wrong[0]] - start <= 2.0 * BLOCK
            out.append(float(at[runs[0][-1]] + at[1] - at[0] - start) if late else 0.0)
    return out


def _scores(
    filters: Sequence[ContactFilter], episodes: Sequence[Episode], beliefs: Sequence[Belief]
) -> dict[str, FunctionScore]:
    """Scores by function."""
    out = {}
    for name in dict.fromkeys(episode.function.name for episode in episodes):
        own = [each for each in zip(filters, episodes, beliefs, strict=True) if each[1].function.name == name]
        judged = [_judge(*each) for each in own]
        right = np.concatenate([r[f] for r, f in judged])
        certain = np.concatenate([belief.probability[:, :-1].max(axis=1) > 0.99 for _, _, belief in own])
        delays = [delay for each in own for delay in _delays(*each)]
        late = float(np.quantile(delays, 0.95)) if delays else float("nan")
        out[name] = FunctionScore(float(right.mean()), len(right), float(certain.mean()), late, len(delays))
    return out


def _seat_off(
    filters: Sequence[ContactFilter], episodes: Sequence[Episode], beliefs: Sequence[Belief]
) -> tuple[float, ...]:
    """Time from the last load of the seat while rising until it is told to be left for good."""
    out = []
    for told, episode, belief in zip(filters, episodes, beliefs, strict=True):
        names, members = _members(told, episode)
        if episode.function.name == "rise":
            said = members[belief.probability.argmax(axis=1), names.index(SEAT)]
            ends = episode.run.time[_blocks(told, len(episode.run.time))]
            left = episode.run.time[np.flatnonzero(episode.truth()[SEAT])[-1]]
            out.append(float(ends[np.flatnonzero(said)[-1]] + BLOCK - left))
    return tuple(out)


def _late(flags: BoolArray, delay: int) -> BoolArray:
    return np.concatenate([np.full(delay, flags[0]), flags[: len(flags) - delay]]) if delay else flags


def _with_switches(
    filters: Sequence[ContactFilter], episodes: Sequence[Episode], logs: Sequence[Recording]
) -> dict[str, float]:
    """Accuracy of modes without switches, and with those of one foot or both that are late or stuck."""
    faults: dict[str, Callable[[BoolArray, int, float], BoolArray]] = {
        "none": lambda flags, foot, rate: flags,
        "80 ms late": lambda flags, foot, rate: _late(flags, round(0.08 * rate)),
        "left stuck closed": lambda flags, foot, rate: flags if foot else np.ones_like(flags),
        "left stuck open": lambda flags, foot, rate: flags if foot else np.zeros_like(flags),
    }
    out = {}
    for name, fault in faults.items():
        right = []
        for told, episode, log in zip(filters, episodes, logs, strict=True):
            if episode.function.name not in ("walk", "stairs up"):
                continue
            flags = {link: fault(log.contacts[link], k, told.rate) for k, link in enumerate(told.feet)}
            judged, far = _judge(told, episode, over(told, log, {} if name == "none" else flags))
            right.append(judged[far])
        out["no switches" if name == "none" else name] = float(np.concatenate(right).mean())
    return out


def _plant_events(
    filters: Sequence[ContactFilter],
    episodes: Sequence[Episode],
    logs: Sequence[Recording],
    count: int,
    rng: np.random.Generator,
) -> EventScore:
    """Plant a random fault in a random piece of the day, and let the coordinator decide."""
    beyond = air = 0
    ended = {"followed": 0, SAFE: 0}
    for _ in range(count):
        k = int(rng.integers(len(episodes)))
        log, episode, told = logs[k], episodes[k], filters[k]
        length = min(len(log), round(4.0 * told.rate))
        start = int(rng.integers(len(log) - length + 1))
        outcome = _one_event(told, episode, log, slice(start, start + length), rng)
        beyond, air = beyond + outcome[0], air + outcome[1]
        ended[outcome[2]] += 1
    return EventScore(count, beyond, air, ended)


def _one_event(
    told: ContactFilter, episode: Episode, log: Recording, piece: slice, rng: np.random.Generator
) -> tuple[bool, bool, str]:
    """One fault: whether torque was beyond limits, whether a leg in the air was to support, and the end."""
    leg, run = told.model.leg, episode.run
    readings = readings_of(told, log)
    arrays = [np.array(x[piece]) for x in (readings.q, readings.tau, readings.gyro, readings.force)]
    known = None if readings.known is None else readings.known[piece]
    flags = {link: np.array(x[piece]) for link, x in readings.switches.items()}
    fault = str(rng.choice(["late", "stuck", "frozen", "request", "torque", "missing"]))
    begin = int(rng.integers(len(arrays[0]) // 4, len(arrays[0]) // 2))
    foot = str(rng.choice(told.feet))
    if fault == "late":
        flags[foot] = _late(flags[foot], round(rng.uniform(0.02, 0.08) * told.rate))
    elif fault == "stuck":
        flags[foot] = np.full_like(flags[foot], bool(rng.integers(2)))
    elif fault == "frozen":
        channel, joint = arrays[int(rng.integers(3))], int(rng.integers(3))
        channel[begin:, joint] = channel[begin, joint]
    elif fault == "torque":
        arrays[1][begin:, int(rng.integers(arrays[1].shape[1]))] += rng.choice([-60.0, 60.0])
    wrong = fault == "missing"
    belief = told.advance(
        told.begin(),
        readings._replace(q=arrays[0], tau=arrays[1], gyro=arrays[2], force=arrays[3], known=known, switches=flags),
    )
    body = Body.of(leg, run.plant.soles)
    functions = {name: make(body) for name, make in FUNCTIONS.items()}
    functions[episode.function.name] = episode.function
    coordinator = Coordinator(functions, np.asarray(leg.limits.effort), rate=1.0 / BLOCK)
    memory = coordinator.begin(episode.function.name)
    ends = _blocks(told, len(arrays[0]))
    phase = episode.phase[piece][ends] % 1.0 if episode.function.cyclic else episode.phase[piece][ends]
    flexion = legs_flexion(leg, run.q[piece][ends])
    truth = {name: x[piece][ends] for name, x in episode.truth().items()}
    request = {int(rng.integers(len(ends))): str(rng.choice(list(functions)))} if fault == "request" else {}
    beyond = in_air = False
    aloft = dict.fromkeys(SIDES, 0.0)
    for j, row in enumerate(belief.probability):
        lost = wrong and ends[j] > begin
        memory.phase = float(phase[j])  # the servo's reference, not the coordinator's, moves the machine
        chances = told.chances(0.0 * row if lost else row)
        decision = coordinator.decide(memory, chances, flexion[j], request.get(j))
        v = run.v[piece][ends[j]]
        wanted = 3.0 * arrays[1][ends[j]]  # three times too much
        torque = coordinator.bound(memory, -DAMPING * v if decision.level == "damping" else wanted, v)
        power = np.abs(torque * v) > coordinator.power * (1.0 + 1e-9)
        beyond |= bool((np.abs(torque) > coordinator.limit * (1.0 + 1e-9)).any() or power.any())
        for side in SIDES:
            aloft[side] = 0.0 if truth[side][j] else aloft[side] + BLOCK
            in_air |= aloft[side] > 0.06 and decision.shares.get(side, 0.0) > 0.0
    return beyond, in_air, SAFE if memory.function == SAFE or decision.level == "damping" else "followed"
