"""Stance law with the truth, the identified model and CAD on the rig with ground. Figures of docs/stance-control.md.

    python scripts/study_on_ground.py                       # 16 seeds from 1000 of both machines
    python scripts/study_on_ground.py --seeds 2 --machine bleex
    python scripts/study_on_ground.py --seeds 8 --coordinated   # contacts are told: docs/coordination.md
    python scripts/study_on_ground.py --seeds 10 --coordinated --faults 10   # with planted events, ten for each seed

The truth of each seed has the mass of every link drawn (± 8 %, one standard deviation) and friction (± 20 %). The
identified model is that of logs with noise: squats, both single supports and swing of BLEEX; of CUHK-EXO a swing in a
stand whose force is measured. CAD is the model of the package without friction. All laws follow the same reference,
planned with the truth, at 500 Hz, and read noisy encoders, IMU and switches.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy
from joblib import Parallel, delayed
from steps_on_ground import STAIRS_DOWN, STAIRS_UP, Steps, stepping

import exoid
from exoid._typing import FloatArray
from exoid.control.functions import (
    FUNCTIONS,
    PHASE,
    SIDES,
    Body,
    Function,
    contact_name,
    joint_angles,
    legs_flexion,
    minimum_jerk,
)
from exoid.control.functions.function import placed
from exoid.control.ground import (
    SAFE,
    SOLES,
    TABLE,
    Belief,
    ContactFilter,
    CoordinatedLoop,
    Coordinator,
    GroundLoop,
    GroundTarget,
    Rule,
    stance,
)
from exoid.control.ground.coordinator import TRANSFER
from exoid.control.ground.hypotheses import BLOCK
from exoid.control.ground.loop import LawLoop
from exoid.errors import ExoidError
from exoid.experiments import ground
from exoid.experiments.ground.planned_motion import (
    LEAD,
    Bearing,
    _bearing,
    follow,
    knots,
    motion_rows,
    planned_motion,
    wave,
)
from exoid.experiments.ground.posture import planar_legs
from exoid.experiments.ground.stance import CLAMP, HAND_RAIL, SWING_GAINS
from exoid.lab.coordination.day import Episode, _bearings, _ground, _reference
from exoid.lab.coordination.study import _delays, _judge, _seat_off
from exoid.leg.model import with_dynamic_parameters
from exoid.rig import Payload, Rates
from exoid.rig.bodies import WINTER
from exoid.rig.ground import (
    HEALTHY,
    PASSIVE,
    Block,
    Faults,
    GroundMotion,
    GroundPlant,
    GroundReading,
    GroundRun,
    GroundSensors,
    GroundWearer,
    Sole,
    Spring,
    simulate_on_ground,
)
from exoid.torques.model import TorqueModel
from exoid.torques.payloads import payload_parameters

RATES = Rates(control=500.0, log=500.0, step=5e-4)
TERMS = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous(), exoid.Armature())
ONE_FOOT = ground.Stance(squat=0.03, shift=0.01, bow=0.05, swing=0.22)
CUHK_FRICTION = {"c0": (1.445, 0.593), "d": (0.038, 0.192), "Ia": (0.8, 0.8)}
SENSORS = GroundSensors(angle_noise=3e-5)  # encoders of 65 536 counts
LIFT, DOWN = 1.5, 3.0
"""Times at which the right foot of BLEEX leaves the ground and is planned to be back [s]."""


def drawn(leg: exoid.Leg, rng: np.random.Generator) -> exoid.Leg:
    """Draw the masses of all links."""
    model = leg.model.copy()
    for j, inertia in enumerate(model.inertias):
        f = np.exp(0.08 * rng.standard_normal())
        model.inertias[j] = pin.Inertia(f * inertia.mass, inertia.lever, f * inertia.inertia)
    return replace(leg, model=model)


def truth_of(machine: str, rng: np.random.Generator) -> GroundPlant:
    """Draw a machine."""
    table = ground.machines.RESISTANCES if machine == "bleex" else CUHK_FRICTION
    leg = drawn(exoid.load_exo(machine, "identified" if machine == "bleex" else None, base="floating"), rng)
    sizes = {name: table[name.split("_")[0]] for name in (f"{s}_{x}" for s in table for x in leg.joint_labels)}
    each = len(next(iter(table.values())))
    values = {name: row[k % each] * np.exp(0.2 * rng.standard_normal()) for k, (name, row) in enumerate(sizes.items())}
    return GroundPlant.build(leg, SOLES[machine], values)


def identified(machine: str, truth: GroundPlant, seed: int, longer: float = 1.0) -> exoid.Estimate:
    """Identify a machine from logs with noise, which may be longer."""
    if machine == "cuhk":
        rng, t = np.random.default_rng(seed), knots(15.0 * longer)
        q = np.array([0.3, 0.8, 0.3, 0.8]) + np.column_stack([wave(t, 0.35, f, rng) for f in (0.6, 0.72, 0.66, 0.8)])
        base = np.column_stack([0.0 * t, 1.4 + wave(t, 0.03, 0.8, rng), wave(t, 0.15, 0.5, rng)])
        run = follow(truth, planned_motion(truth, t, q, base, {}), SWING_GAINS_CUHK, spring=CLAMP)
        log = run.recording(replace(SENSORS, torque_noise=(0.5, 0.4)), seed)
        return exoid.identify(exoid.load_exo("cuhk", base="floating"), log, TERMS, check=False)
    each = 20.0 * longer
    runs = {
        "squats": ground.squats_and_shifts(truth, each, seed=seed),
        "left": ground.single_support(truth, each, standing=0, stance=ONE_FOOT, seed=seed + 1),
        "right": ground.single_support(truth, each, standing=1, stance=ONE_FOOT, seed=seed + 2),
        "swing": ground.swing(truth, each, scale=0.85, seed=seed + 3),
    }
    logs = [run.recording(seed=seed + k, wrenches=set(run.wrenches) & {"torso"}) for k, run in enumerate(runs.values())]
    return exoid.identify(exoid.load_exo("bleex", base="floating"), logs, TERMS, check=False)


SWING_GAINS_CUHK = replace(SWING_GAINS, stiffness=(600.0, 400.0), damping=(30.0, 20.0))


def cuhk_motion(truth: GroundPlant, seed: int) -> GroundMotion:
    """Plan squats of CUHK-EXO with one foot 0.3 m before the other; its ankles are points."""
    rng, t = np.random.default_rng(seed), knots(5.0)
    x, z = wave(t, 0.02, 0.6, rng), 0.76 + wave(t, 0.03, 0.5, rng)
    pitch, q = wave(t, 0.06, 0.42, rng) - 0.05, []
    for foot in (0.15, -0.15):
        way, upper, lower = foot - x - 1j * z, 0.4165, 0.4182  # down is −i, forward 1
        knee = np.arccos((np.abs(way) ** 2 - upper**2 - lower**2) / (2.0 * upper * lower))
        thigh = np.angle(way) - np.angle(upper + lower * np.exp(-1j * knee)) + np.pi / 2
        q += [thigh - pitch, knee]
    base = np.column_stack([x, z, pitch])
    return planned_motion(truth, t, np.column_stack(q), base, {})


def step_motion(truth: GroundPlant) -> GroundMotion:
    """Plan one step of BLEEX in place: the right foot rises by 6 cm and comes back, 2 mm too deep for 0.6 s."""
    t = knots(5.0)
    motion = ground.stance_motion(truth, 5.0, stance=ground.Stance(squat=0.0, shift=0.0, bow=0.0))
    up = minimum_jerk((t - LIFT) / 0.5) - minimum_jerk((t - DOWN + 1.0) / 1.0)
    deep = minimum_jerk((t - DOWN + 0.3) / 0.3) - minimum_jerk((t - DOWN - 0.6) / 0.3)
    q, leg = motion.q.copy(), planar_legs(truth)[1]
    height = 0.06 * up - 0.002 * deep
    q[:, leg.joints] = leg.angles(motion.base, 1j * height, np.zeros(len(t)))
    return replace(motion, q=q)


def step_shares(now: float) -> dict[str, float]:
    """Share of the right foot: none while it is up."""
    going = 1.0 - float(minimum_jerk((now - LIFT + 0.5) / 0.5))
    return {"right_foot": going if now < DOWN - 0.4 else 1.0}


def free_functions(truth: GroundPlant) -> dict[str, Function]:
    """Stand, squat by 8 cm and take one step of 6 cm in place, balanced without a rail."""

    def still(height: float) -> tuple[FloatArray, FloatArray]:
        stance = ground.Stance(height=height, squat=0.0, shift=0.0, bow=0.0)
        motion = ground.stance_motion(truth, 1.0, stance=stance)
        return motion.q[0], motion.base[0]

    heights = np.linspace(0.80, 0.88, 5)
    curve = scipy.interpolate.CubicSpline(heights, [np.hstack(still(h)) for h in heights])
    n, leg, both = len(truth.leg.joint_names), planar_legs(truth)[1], frozenset(SIDES)
    deep = 0.5 * (1.0 - np.cos(2.0 * np.pi * minimum_jerk(PHASE)))
    up = minimum_jerk((PHASE - 0.25) / 0.2) - minimum_jerk((PHASE - 0.45) / 0.3)
    out = {}
    for name, seconds, height, lift, order in (
        ("stand", 1.0, 0.88 + 0.0 * PHASE, 0.0, ((0.0, both),)),
        ("squat", 2.5, 0.88 - 0.08 * deep, 0.0, ((0.0, both),)),
        ("step", 2.5, 0.88 + 0.0 * PHASE, 0.06, ((0.0, both), (0.25, frozenset(("left",))), (0.72, both))),
    ):
        x = curve(height)
        q, base = x[:, :n], x[:, n:]
        q[:, leg.joints] = leg.angles(base, 1j * lift * up, 0.0 * PHASE)
        flexion = legs_flexion(truth.leg, q)
        out[name] = Function(name, seconds, flexion, base, order)
    return out


def cuhk_functions(body: Body) -> dict[str, Function]:
    """Stand, squat by 8 cm and lift the right foot by 6 cm, on point feet side by side and a rail."""
    deep = 0.5 * (1.0 - np.cos(2.0 * np.pi * minimum_jerk(PHASE)))
    up = minimum_jerk((PHASE - 0.25) / 0.2) - minimum_jerk((PHASE - 0.45) / 0.3)
    both, left, out = frozenset(SIDES), frozenset(("left",)), {}
    for name, seconds, sinks, lift, order in (
        ("stand", 1.0, 0.0, 0.0, ((0.0, both),)),
        ("squat", 2.5, 0.08, 0.0, ((0.0, both),)),
        ("step", 2.5, 0.0, 0.06, ((0.0, both), (0.25, left), (0.75, both))),
    ):
        hip = 1j * (0.93 * body.leg - sinks * deep)
        feet = {"left": 0j * PHASE, "right": 1j * lift * up}
        out[name] = placed(name, body, seconds, hip, 0.0 * PHASE, order, feet=feet)
    return out


class Noted(CoordinatedLoop):
    """Loop that notes the probability of each set of contacts at every sample."""

    def __post_init__(self) -> None:
        """Begin the notes."""
        super().__post_init__()
        self.told: list[FloatArray] = []

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque, and note what is told."""
        torque = super().__call__(reading)
        self.told.append(self._told.probability.copy())
        return torque


def filter_of(model: exoid.Estimate | GroundPlant | exoid.Leg, soles: Mapping[str, Sole]) -> ContactFilter:
    """Filter of an estimate, of the true machine, or of CAD without friction; the last two believe their numbers."""
    if isinstance(model, exoid.Estimate):
        return ContactFilter.of(model, soles, rate=RATES.control)
    leg = model.leg if isinstance(model, GroundPlant) else model
    torques = TorqueModel(leg, TERMS)
    known = (
        model.values if isinstance(model, GroundPlant) else dict(zip(leg.parameter_names, leg.parameters, strict=True))
    )
    values = np.array([known.get(name, 0.0) for name in torques.names])
    return ContactFilter(torques, values, 0.0 * np.diag(values), soles, np.zeros(3), RATES.control)


class Event(NamedTuple):
    """Something that goes wrong, with its name."""

    name: str = "none"
    faults: Faults = Faults()
    friction: float = 0.8  # coefficient of friction of the ground
    requests: Mapping[float, str] = MappingProxyType({})  # beside those of the study, by time [s]
    missed: float = 0.0  # height by which the ground is not where it is planned, from the second step on [m]

    @classmethod
    def drawn(cls, names: Sequence[str], functions: Sequence[str], rng: np.random.Generator, *, walks: bool) -> Event:
        """Draw one, from 0.3 s on."""
        name, when = str(rng.choice(EVENTS if walks else EVENTS[:-1])), float(rng.uniform(0.3, 2.5))
        if name == "missed step":
            return cls(name, missed=float(rng.choice((-1.0, 1.0)) * rng.uniform(0.01, 0.03)))
        if name == "slippery ground":
            return cls(name, friction=float(rng.uniform(0.1, 0.4)))
        if name == "request in between":
            return cls(name, requests={when: str(rng.choice(functions))})
        return cls(name, Faults(frozen={"pitch" if name == "frozen pitch" else str(rng.choice(names)): when}))


SUNK = 500.0
"""Distance of a joint from where support ended from which the machine has sunk or fallen [mrad]."""

EVENTS = ("frozen joint", "frozen pitch", "slippery ground", "request in between", "missed step")
"""Names of planted events; the last one is of walks alone."""

NOTHING = Event()


def walked(
    truth: GroundPlant,
    model: exoid.Estimate | GroundPlant | exoid.Leg,
    name: str,
    seed: int,
    event: Event = NOTHING,
) -> FloatArray:
    """Take four steps and stand, balanced by the law alone; the wearer is paralysed."""
    steps = WALKS[name]
    functions = stepping(truth, steps)
    L, climb, off, blocks, floor = steps.length, steps.climb, event.missed, tuple[Block, ...](), 0.0
    if climb > 0.0:
        blocks = tuple(Block((j - 0.5) * L, 20.0 * L, j * climb + (j > 1) * off) for j in range(1, 8))
    elif climb < 0.0:
        blocks = tuple(Block(-2.0, (j + 0.5) * L, (j - 8) * climb + (j > 1) * off) for j in range(8))
        floor = -8.0 * climb
    elif off:
        blocks, floor = (Block(1.5 * L, 20.0 * L, off) if off > 0.0 else Block(-2.0, 1.5 * L, -off),), max(0.0, -off)
    where = replace(truth, blocks=blocks, ground_lean=steps.slope, ground_friction=event.friction)
    x, z, pitch = functions["stand"].torso[0]
    place = np.exp(-1j * steps.slope) * (x + 1j * z) + 1j * (floor + 5e-4)  # in the axes of the ground
    names = ("first step", "steps", "last step")
    first, stride, last = (functions[key].duration for key in names)
    t = knots(1.8 + first + stride + last)
    q = np.tile(joint_angles(truth.leg, functions["stand"].flexion[:1]), (len(t), 1))
    base = np.tile([place.real, place.imag, pitch - steps.slope], (len(t), 1))
    table = [Rule("stand", "request", names[0]), Rule(names[0], "end", names[1])]
    table += [Rule(names[1], "request", names[2]), Rule(names[2], "end", "stand"), Rule(SAFE, "known", "stand")]
    coordinator = Coordinator(functions, truth.leg.limits.effort, table, rate=RATES.control)
    requests = {0.3: names[0], 0.3 + first + 0.5 * stride: names[2], **event.requests}
    told = filter_of(model, where.soles)
    loop = Noted(stance(model, where.soles), told, coordinator, requests, lean=steps.slope)
    motion = GroundMotion(t, q, 0.0 * q, base)
    plans = {
        key: planned_torque(where, each, np.zeros((len(PHASE), 3)), steps.slope) for key, each in functions.items()
    }
    return judged(where, motion, loop, functions["last step"], None, PASSIVE, seed, event, plans)


def pulled(
    plant: GroundPlant, motion: GroundMotion, bearings: Mapping[str, Bearing], rail: Spring
) -> tuple[GroundMotion, FloatArray]:
    """Let the hand on a rail pull, so that no sole bears a moment: its carriage leads the torso. And its force."""
    b, q, base = plant.leg.base_rows, motion.q, motion.base
    hand = _bearing(plant, q, base, plant.root_link, Bearing(np.ones(len(q)), np.array(rail.point)), held=False)[0]
    parts = [_bearing(plant, q, base, link, each, held=False) for link, each in bearings.items()]
    # soles bear hardly any moment, and a seat bears before the hand pulls
    J = np.concatenate([hand[:, :1], *(x for x, _ in parts)], axis=1)[:, :, :b]
    S = np.hstack([np.full((len(q), 1), 0.1), *(x * [1.0, 1.0, 1e-6] for _, x in parts)])
    rows = motion_rows(plant, motion.time, q, base)[:, :b, None]
    pull = 0.1 * np.einsum("nk,nk->n", J[:, 0], np.linalg.solve(np.einsum("nki,nk,nkj->nij", J, S, J), rows)[..., 0])
    ahead = pull / rail.stiffness[0] * minimum_jerk(motion.time + LEAD)
    rate = scipy.interpolate.CubicSpline(motion.time, ahead)(motion.time, 1)
    force = rail.stiffness[0] * ahead + rail.damping[0] * rate  # on a torso that moves as planned
    return replace(motion, base=base + np.outer(ahead, [1.0, 0.0, 0.0])), hand[:, 0, :b] * force[:, None]


def planned_torque(plant: GroundPlant, function: Function, pull: FloatArray, lean: float = 0.0) -> FloatArray:
    """Torque [N·m] that a function takes with the truth, on planned contacts and shares, under a pull, (K, n)."""
    loop = LawLoop(stance(plant, plant.soles), lean=lean)
    pose = np.column_stack([joint_angles(plant.leg, function.flexion), function.torso[:, 2]])
    curve, planned, out = scipy.interpolate.CubicSpline(PHASE, pose), dict[str, FloatArray](), []
    for link in plant.soles:  # shares as the coordinator's, in the time after a touch-down and before a lift-off
        on = np.array([contact_name(plant.leg, link) in function.expected(p) for p in PHASE])
        wide = np.pad(on, len(on), mode="wrap" if function.cyclic else "edge")
        away = np.inf if on.all() else scipy.ndimage.distance_transform_edt(wide)[len(on) : -len(on)]
        seconds = (away + 0.0 * on) / (len(PHASE) - 1) * function.duration
        planned[link] = minimum_jerk(seconds / TRANSFER)
    for k, p in enumerate(PHASE):
        x, v, a = (curve(p, order) / function.duration**order for order in range(3))
        target = GroundTarget(x[:-1], v[:-1], a[:-1], x[-1], v[-1], a[-1])
        reading = GroundReading(0.0, x[:-1], v[:-1], x[-1], v[-1], {}, pull[k], np.zeros(3), np.zeros(len(x) - 1))
        shares = {link: float(share[k]) for link, share in planned.items() if share[k] > 0.0}
        out.append(loop.supported(reading, shares, target, x))
    return np.array(out)


def coordinated(
    truth: GroundPlant, model: exoid.Estimate, name: str, wearer: GroundWearer, seed: int, event: Event = NOTHING
) -> FloatArray:
    """Do one function in closed loop, with a hand on a rail where BLEEX has no balance, and for CUHK-EXO always."""
    points = truth.leg.limbs[0].chain.n == 2
    free = name in ("squat", "step")
    body = Body.of(truth.leg, truth.soles)
    made = {} if not free else cuhk_functions(body) if points else free_functions(truth)
    functions = made or {key: make(body) for key, make in FUNCTIONS.items()}
    function, where = functions[name], truth if free else _ground(truth, name, body, {})
    where = replace(where, ground_friction=event.friction)
    t = knots(function.duration + 1.5)
    phase = np.clip((t - 0.3) / function.duration, 0.0, 1.0)
    flexion, base = _reference(function, phase)
    q = scipy.interpolate.CubicSpline(PHASE, joint_angles(truth.leg, function.flexion))(phase)
    bearings = _bearings(where, function, phase, flexion, base)
    motion = planned_motion(where, t, q, base, bearings, held=points)
    rail, pull = HAND_RAIL if points or not free else None, np.zeros((len(t), 3))
    if rail is not None:
        motion, pull = pulled(where, motion, bearings, rail)
    start, end = "sit" if name == "rise" else "stand", "sit" if name == "sit" else "stand"
    plan = planned_torque(where, function, scipy.interpolate.CubicSpline(t, pull)(0.3 + PHASE * function.duration))
    plans = {start: plan[:1], end: plan[-1:], name: plan}
    rules = [Rule("stand", "request", key) for key in made if key != "stand"]
    rules += [Rule(key, "end", "stand") for key in made if key != "stand"]
    table = (*rules, Rule(SAFE, "known", "stand")) if made else TABLE
    coordinator = Coordinator(functions, truth.leg.limits.effort, table, rate=RATES.control)
    told = filter_of(model, where.soles)
    loop = Noted(stance(model, where.soles), told, coordinator, {0.3: name, **event.requests}, start)
    return judged(where, motion, loop, function, rail, wearer, seed, event, plans)


def judged(
    plant: GroundPlant,
    motion: GroundMotion,
    loop: Noted,
    function: Function,
    rail: Spring | None,
    wearer: GroundWearer,
    seed: int,
    event: Event,
    plans: Mapping[str, FloatArray],
) -> FloatArray:
    """Run a loop: its end, figures of :data:`COORDINATED`, sunk, goes on, safe."""
    try:
        run = simulate_on_ground(
            plant,
            motion,
            loop,
            rates=RATES,
            spring=rail,
            sensors=SENSORS,
            wearer=wearer,
            faults=event.faults,
            seed=seed,
        )
    except ExoidError:
        return np.array([0.0, *[np.nan] * len(COORDINATED), 0.0, 0.0])
    shown = loop.decisions[-len(run.time) :]
    last, names = shown[-1], {contact_name(plant.leg, link): foot for link, foot in run.feet.items()}
    end = "sit" if function.name == "sit" else "stand"
    far = np.abs(legs_flexion(plant.leg, run.q[-1:])[0] - function.flexion[-1]).max()
    safe = any(d.function == SAFE for d in loop.decisions)
    runs, levels = loop.coordinator.functions.get(last.function), {d.level for d in shown[-round(0.2 * RATES.log) :]}
    posture = function.flexion[-1] if runs is None else runs.flexion[round(last.phase * (len(PHASE) - 1))]
    away = np.abs(legs_flexion(plant.leg, run.q[-1:])[0] - posture).max()
    goes_on = runs is not None and "support" in levels and "damping" not in levels and away < 0.1
    ended = goes_on and last.level == "support" and last.function == end and far < 0.1 and not safe
    aloft = 0.0
    for side in SIDES:
        air = 0
        for on, d in zip(names[side].touching, shown, strict=True):
            air = 0 if on else air + 1
            aloft = max(aloft, air / RATES.log if d.shares.get(side, 0.0) > 0.0 else 0.0)
    damped = sum(d.level == "damping" for d in shown) / RATES.log
    curves = {
        key: scipy.interpolate.CubicSpline(PHASE, joint_angles(plant.leg, each.flexion))
        for key, each in loop.coordinator.functions.items()
    }
    planned = np.array(
        [q if d.function == SAFE else curves[d.function](d.phase) for d, q in zip(shown, run.q, strict=True)]
    )
    error = np.sqrt(np.mean((run.q - planned) ** 2))
    held = 0.0 if rail is None else np.linalg.norm(run.wrenches[plant.root_link].force, axis=1).max()
    rows, each = np.array(loop.told[-len(run.time) :]), replace(loop.contacts, rate=1.0 / BLOCK)  # a row a sample
    episode, belief = Episode(function, run, 0.0 * run.time, run.q), Belief(rows, np.zeros(0))
    right, sure = _judge(each, episode, belief)
    late = [*_delays(each, episode, belief), *_seat_off([each], [episode], [belief])]
    wrong = 100.0 * float(np.mean(~right[sure]))
    delay = 1e3 * float(np.quantile(late, 0.95)) if late else np.nan
    knees = [limb.joints.start + 1 for limb in plant.leg.limbs]
    plan = np.full((len(run.time), len(knees)), np.nan)
    for k, d in enumerate(shown):
        if d.function in plans:
            rows = plans[d.function][:, knees]
            plan[k] = rows[min(round(d.phase * (len(PHASE) - 1)), len(rows) - 1)]
    beside = (run.tau + run.interaction)[:, knees] - plan
    figures = [1e3 * far, 1e3 * error, 1e3 * damped, 1e3 * aloft, np.abs(run.tau).max(), held, wrong, delay]
    figures.append(100.0 * float(np.sqrt(np.nanmean(beside**2) / np.mean(plan[np.isfinite(beside)] ** 2))))
    stops = [k for k, d in enumerate(shown) if d.level == "damping"]
    moved = legs_flexion(plant.leg, run.q[[-1, stops[0]]] if stops else run.q[[-1, -1]])
    figures.append(0.0 if goes_on else 1e3 * float(np.abs(moved[0] - moved[1]).max()))
    figures += [float(goes_on), float(last.function == SAFE or last.level == "damping")]
    return np.array([ended, *figures])


COORDINATED = (
    "ended",
    "end [mrad]",
    "rms [mrad]",
    "damped [ms]",
    "air [ms]",
    "torque [N·m]",
    "rail [N]",
    "wrong [%]",
    "delay [ms]",
    "knees [%]",
)
"""Columns of the closed loop: errors of joints at the end and RMS, time of damping and of support in the air, largest
forces, contacts told wrong further than 100 ms from a transition, 95 % of delays, and RMS of the torque of the knees
beside what the function takes at its phase with the truth, on planned contacts and shares, under the planned pull."""

WALKS = {
    "walk": Steps(),
    "slope": Steps(slope=0.08),
    "stairs up": STAIRS_UP,
    "stairs down": STAIRS_DOWN,
}
"""Steps of BLEEX without hands."""


def wearer_bodies(leg: exoid.Leg, rng: np.random.Generator | None = None) -> list[Payload]:
    """Bodies of a wearer of 75 kg and 1.75 m on the links, by Winter's table or drawn about it (5 and 10 %)."""
    mass, height, draw = 75.0, 1.75, rng or np.random.default_rng()

    def about(value: float, spread: float) -> float:
        return value if rng is None else value * float(np.exp(spread * draw.standard_normal()))

    trunk = 0.288 * height  # head, arms and trunk, of the hip
    out = [Payload(leg.description.root_link, about(0.678 * mass, 0.05), (0.0, 0.0, about(0.626 * trunk, 0.05)), 0.25)]
    for limb in leg.limbs:
        joints = leg.joint_names[limb.joints]
        for joint, part in ((joints[0], WINTER["hip"]), (joints[1], WINTER["knee"])):
            weight, _, below, gyration = part
            place = (0.0, 0.0, about(-below * height, 0.05))
            out.append(Payload(joint, about(weight * mass, 0.1), place, gyration * height))
        foot = -0.04 if len(joints) > 2 else 0.04 - Body.of(leg, SOLES["cuhk"]).shank  # below the last joint
        out.append(Payload(joints[-1], 0.0145 * mass, (0.05, 0.0, foot)))
    return out


def worn(truth: GroundPlant, model: exoid.Estimate, seed: int) -> tuple[GroundPlant, exoid.Estimate]:
    """Fix a wearer to the machine, drawn about the table, and the table to the estimate; with drives of 350 N·m."""

    def loaded(leg: exoid.Leg, bodies: list[Payload]) -> exoid.Leg:
        links, added = dict(zip(leg.joint_names, leg.link_names, strict=True)), np.zeros((len(leg.bodies), 10))
        for body in bodies:
            inertia = pin.Inertia(body.mass, np.array(body.position), body.mass * body.gyration**2 * np.eye(3))
            added[leg.bodies.index(links.get(body.joint, body.joint))] += inertia.toDynamicParameters()
        model = with_dynamic_parameters(leg.model, leg.link_parameters + added.ravel())
        model.effortLimit = np.full(model.nv, 350.0)
        return replace(leg, model=model)

    leg, rng = model.model.leg, np.random.default_rng(0)
    places = [model.names.index(name) for name in leg.parameter_names]
    values, covariance = model.values.copy(), model.covariance.copy()
    values[places] += payload_parameters(leg, wearer_bodies(leg))
    spread = np.array([payload_parameters(leg, wearer_bodies(leg, rng)) for _ in range(400)])
    covariance[np.ix_(places, places)] += np.cov(spread.T)
    own = replace(model.model, leg=loaded(leg, wearer_bodies(leg)))
    true = loaded(truth.leg, wearer_bodies(truth.leg, np.random.default_rng([seed, 75])))
    return replace(truth, leg=true), replace(model, model=own, values=values, covariance=covariance)


def all_worn(machine: str, seed: int, _: str | None = None) -> dict[tuple[str, str], FloatArray]:
    """Figures of a seed with a wearer of 75 kg, who makes no or half of the planned torque."""
    warnings.simplefilter("ignore")
    truth = truth_of(machine, np.random.default_rng(seed))
    truth, model = worn(truth, identified(machine, truth, 10 * seed), seed)
    wearers = {"passive": PASSIVE, "half": GroundWearer(effort=0.5)}
    return {(n, w): coordinated(truth, model, n, wearers[w], seed) for n in ("rise", "sit", "squat") for w in wearers}


def all_coordinated(machine: str, seed: int, only: str | None = None) -> dict[tuple[str, str], FloatArray]:
    """Figures of a seed by function and wearer."""
    warnings.simplefilter("ignore")
    truth = truth_of(machine, np.random.default_rng(seed))
    model = identified(machine, truth, 10 * seed)
    out, wearers = {}, {"passive": PASSIVE, "healthy": HEALTHY}
    for name in ("rise", "sit", "squat", "step"):
        out |= {(name, who): wearers[who] for who in wearers if only in (None, name)}
    out = {key: coordinated(truth, model, key[0], who, seed) for key, who in out.items()}
    if machine == "bleex":
        out |= {(name, "passive"): walked(truth, model, name, seed) for name in WALKS if only in (None, name)}
        models = {"truth": truth, "CAD": exoid.load_exo("bleex", base="floating")}
        if only in (None, "walk"):
            out |= {("walk", who): walked(truth, each, "walk", seed) for who, each in models.items()}
    return out


def planted(machine: str, seed: int, count: int, only: str | None = None) -> list[tuple[str, str, FloatArray]]:
    """Figures of random functions with random events, or with one kind of them, by the names of both."""
    warnings.simplefilter("ignore")
    rng, truth = np.random.default_rng([seed, 7]), truth_of(machine, np.random.default_rng(seed))
    model, out = identified(machine, truth, 10 * seed), []
    walks = (*WALKS,) * (machine == "bleex")
    for _ in range(count):
        name = str(rng.choice(("rise", "sit", "squat", "step", *walks)))
        known = ("stand", "squat", "step") if name in ("squat", "step") else ("stand", "rise", "sit", "walk")
        known = ("first step", "steps", "last step") if name in WALKS else known
        event = Event.drawn(truth.leg.joint_names, known, rng, walks=name in WALKS)
        if only not in (None, event.name):
            continue
        case = walked(truth, model, name, seed, event) if name in WALKS else None
        out.append((name, event.name, coordinated(truth, model, name, PASSIVE, seed, event) if case is None else case))
    return out


def print_planted(machine: str, seeds: range, jobs: int, count: int, only: str | None) -> None:
    """Run functions with planted events, and print how they end."""
    found = [*chain(*Parallel(n_jobs=jobs)(delayed(planted)(machine, s, count, only) for s in seeds))]
    print(f"{machine}: {len(found)} planted events, seeds from {seeds[0]}")
    headers = ("cases", "done", "goes on", "safe stop", "neither", "sunk", "support in the air", "torque [N·m]")
    print(f"{'':20s}" + "".join(f"{name:>20s}" for name in headers))
    for event in dict.fromkeys(name for _, name, _ in found):
        rows = np.array([figures for _, name, figures in found if name == event]).reshape(-1, len(COORDINATED) + 3)
        done, goes_on, safe = (rows[:, [0, -2, -1]] > 0.0).T
        air = rows[:, COORDINATED.index("air [ms]")] > 60.0
        sunk = rows[:, -3] > SUNK
        ends = done, goes_on & ~done, safe, ~(done | goes_on | safe), sunk, air
        counts = len(rows), *(int(end.sum()) for end in ends)
        most = np.nanmax(rows[:, COORDINATED.index("torque [N·m]")], initial=0.0)
        print(f"{event:20s}" + "".join(f"{x:20d}" for x in counts) + f"{most:20.4g}", flush=True)
    for name, event, figures in found:
        if not any(figures[[0, -2, -1]]) or figures[COORDINATED.index("air [ms]")] > 60.0:
            print(f"    neither, or in the air: {name}, {event}: {', '.join(f'{x:.3g}' for x in figures[1:])}")


def print_coordinated(machine: str, seeds: range, jobs: int, only: str | None) -> None:
    """Run the closed loop, and print how many cases end as they should, and the largest figures."""
    calls = (delayed(all_worn if only == "worn" else all_coordinated)(machine, s, only) for s in seeds)
    found = []
    for each in Parallel(n_jobs=jobs, return_as="generator")(calls):
        found.append(each)
        print(f"{machine}: {len(found)} of {len(seeds)} seeds", file=sys.stderr)
    print(f"{machine}: {len(seeds)} seeds from {seeds[0]}; ended, and the worst of each figure")
    print(f"{'':20s}" + "".join(f"{name:>13s}" for name in COORDINATED))
    for name, who in found[0]:
        rows = np.array([each[name, who] for each in found])
        *cells, _, _, _ = np.fmax.reduce(rows[:, 1:], axis=0)
        print(f"{name:11s} {who:8s}{int(rows[:, 0].sum()):8d} of {len(rows)}" + "".join(f"{x:13.3g}" for x in cells))


class Probe(GroundLoop):
    """Loop that notes by how much a change of contacts alone moves the torque, in the same state."""

    own: float = 0.0

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque, and again with the contacts of the last sample where they have changed."""
        before, torque = self.state, super().__call__(reading)
        now = self.state
        if reading.time > 0.0 and before and now and now.contacts and set(before.contacts) ^ set(now.contacts):
            same = now._replace(contacts=before.contacts, shares=before.shares)
            other = self.law.command(same, self.target(reading.time)).torque
            self.own = max(self.own, float(np.abs(torque - other).max()))
        return torque


def figures(loop: Probe, run: GroundRun) -> dict[str, float]:
    """Figures of one run."""
    wanted = [loop.target(t) for t in run.time]
    pitch = np.arctan2(run.rotation[:, 2, 0], run.rotation[:, 0, 0])
    q = 1e3 * (run.q - np.array([t.q for t in wanted]))
    out = {"joints [mrad]": float(np.sqrt((q**2).mean())), "largest joint [mrad]": float(np.abs(q).max())}
    out["torso [mrad]"] = 1e3 * float(np.sqrt(np.mean((pitch - [t.pitch for t in wanted]) ** 2)))
    changes, tipped, slipped, used = np.zeros(len(run.time), dtype=bool), 0, 0, 0.0
    for link, foot in run.feet.items():
        settled = np.convolve(foot.touching, np.ones(101), "same") > 100.5  # 0.1 s around touch-down and lift-off
        tipped += int(np.count_nonzero(settled & (foot.points < len(run.plant.soles[link].points))))
        slipped += int(np.count_nonzero(settled & (foot.slip > 0.005)))
        loaded = settled & (foot.force[:, 2] > 20.0)
        used = max(used, float((np.abs(foot.force[loaded, 0]) / foot.force[loaded, 2]).max(initial=0.0)))
        change = np.flatnonzero(np.diff(foot.touching))
        changes[(change[:, None] + np.arange(-10, 11)).clip(0, len(changes) - 1)] = True
    out |= {"samples tipped": tipped, "samples slipped": slipped, "friction used, of 0.8": used}
    every = np.abs(np.diff(run.tau, axis=0))
    steps = every[changes[1:]]
    out["step by change of contact [N·m]"] = loop.own
    out["step by change of contact [% of range]"] = 100.0 * loop.own / float(np.ptp(run.tau, axis=0).max())
    out["step at changes [N·m]"] = float(steps.max()) if len(steps) else 0.0
    out["step at changes [% of range]"] = 100.0 * float((steps / np.ptp(run.tau, axis=0)).max()) if len(steps) else 0.0
    elsewhere = np.quantile(every[~changes[1:]], 0.99, axis=0) / np.ptp(run.tau, axis=0)
    out["99 % of steps elsewhere [% of range]"] = 100.0 * float(elsewhere.max())
    # between samples noise of encoders times gains counts as well; not in means over 10 ms before and after
    means = np.lib.stride_tricks.sliding_window_view(run.tau, 5, axis=0).mean(axis=2)
    shifts, near = 100.0 * np.abs(means[5:] - means[:-5]) / np.ptp(run.tau, axis=0), changes[5:-4]
    out["mean shift at changes [% of range]"] = float(shifts[near].max()) if near.any() else 0.0
    out["largest mean shift elsewhere [% of range]"] = float(shifts[~near].max())
    out["infeasible [%]"] = 100.0 * float(np.mean([not (c and c.feasible) for c in loop.commands]))
    return out


def one(machine: str, seed: int, only: str | None = None, longer: float = 1.0) -> dict[tuple[str, str, str], float]:
    """All figures of a seed, by motion, model and name."""
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(seed)
    truth = truth_of(machine, rng)
    models = {"truth": truth, "identified": identified(machine, truth, 10 * seed, longer)}
    models["CAD"] = exoid.load_exo(machine, base="floating")
    if machine == "bleex":
        motions = {"squats": (ground.stance_motion(truth, 5.0, seed=seed), None)}
        motions["step"] = step_motion(truth), step_shares
    else:
        motions = {"squats": (cuhk_motion(truth, seed), None)}
    out = {}
    for motion, (reference, shares) in motions.items():
        if only not in (None, motion):
            continue
        for model, source in models.items():
            loop = Probe(stance(source), reference, shares)
            try:
                run = simulate_on_ground(truth, reference, loop, rates=RATES, sensors=SENSORS, seed=seed)
            except ExoidError:
                out[motion, model, "falls"] = 1.0
                continue
            found = figures(loop, run)
            found["falls"] = float(found["largest joint [mrad]"] > 500.0)
            out |= {(motion, model, name): value for name, value in found.items()}
    return out


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--coordinated", action="store_true", help="the loop that tells its contacts")
    parser.add_argument("--faults", type=int, default=0, help="coordinated: planted events for each seed")
    parser.add_argument("--machine", choices=("bleex", "cuhk"), default=None)
    parser.add_argument("--motion", default=None, help="squats or step; coordinated: rise, sit, ..., or worn; an event")
    parser.add_argument("--longer", type=float, default=1.0, help="logs are so many times as long")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    if options.coordinated:
        for machine in (options.machine,) if options.machine else ("bleex", "cuhk"):
            if options.faults:
                print_planted(machine, seeds, options.jobs, options.faults, options.motion)
            else:
                print_coordinated(machine, seeds, options.jobs, options.motion)
        return
    for machine in (options.machine,) if options.machine else ("bleex", "cuhk"):
        begun = time.perf_counter()
        found = []
        for each in Parallel(n_jobs=options.jobs, return_as="generator")(
            delayed(one)(machine, s, options.motion, options.longer) for s in seeds
        ):
            found.append(each)
            print(f"{machine}: {len(found)} of {options.seeds} seeds", file=sys.stderr)
        print(f"{machine}: {options.seeds} seeds from {options.first}; mean and worst of each model")
        for motion, name in dict.fromkeys((m, n) for m, _, n in (key for each in found for key in each)):
            cells = []
            for model in ("truth", "identified", "CAD"):
                values = np.array([each[motion, model, name] for each in found if (motion, model, name) in each])
                cells.append(f"{values.mean():9.3g} {values.max():9.3g}" if len(values) else " " * 19)
            print(f"{motion:7s} {name:38s}" + "  |".join(cells))
        for motion in dict.fromkeys(m for m, _, _ in found[0]):
            for name in ("joints [mrad]", "torso [mrad]"):
                rows = [
                    [each.get((motion, model, name), np.nan) for model in ("truth", "identified", "CAD")]
                    for each in found
                ]
                truth, identified, cad = np.array(rows).T
                print(
                    f"{motion:7s} {name:38s} identified/truth {np.nanmax(identified / truth):.3f} (worst), "
                    f"identified/CAD {np.nanmax(identified / cad):.3f} (worst)"
                )
        print(f"{time.perf_counter() - begun:.0f} s")


if __name__ == "__main__":
    main()
