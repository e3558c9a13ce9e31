"""A day in three minutes on the virtual rig: sit, rise, walk, stairs, sit; each run begins and ends at rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.control.functions import (
    FUNCTIONS,
    PHASE,
    SEAT,
    SIDES,
    Body,
    Function,
    contact_name,
    joint_angles,
    minimum_jerk,
    seated_hip,
)
from exoid.errors import BadArgumentError
from exoid.experiments.ground import bleex_machine, cuhk_machine
from exoid.experiments.ground.planned_motion import KNOTS, LEAD, Bearing, planned_motion
from exoid.experiments.ground.posture import total_mass
from exoid.experiments.ground.walking import GAINS as WALKING
from exoid.experiments.ground.walking import HARNESS
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import Block, GroundPlant, GroundRun, JointGains, simulate_on_ground
from exoid.rig.ground.plant import SEAT as SEAT_SOLE
from exoid.signals.contacts import LEAST_LOAD

MACHINES: Mapping[str, Callable[[], GroundPlant]] = {"bleex": bleex_machine, "cuhk": cuhk_machine}
"""Machines by name."""

GAINS = {3: WALKING, 2: JointGains(stiffness=(1000.0, 800.0), damping=(40.0, 30.0))}
"""Gains of the servo by the number of joints of a leg: those of walking in a harness."""

SEAT_HEIGHT, RISER, TREAD, STEPS = 0.45, 0.17, 0.29, 12
"""Height of the chair [m], size of the steps [m] and their number."""

PLAN = (
    ("sit", 0.06),
    ("rise", 0.05),
    ("stand", 0.04),
    ("walk", 0.42),
    ("stairs up", 0.14),
    ("stairs down", 0.14),
    ("slope", 0.09),
    ("sit", 0.06),
)
"""Functions of the day in order, and their shares of it."""


@dataclass(frozen=True, eq=False)
class Episode:
    """One function on the rig."""

    function: Function
    run: GroundRun  # truth
    phase: FloatArray  # phase of the reference, from 0 to the number of cycles, (N,)
    planned: FloatArray  # reference of the joints [rad], (N, n)

    def truth(self) -> dict[str, BoolArray]:
        """Contacts that bear load, by the names of functions, (N,) each."""
        return {
            contact_name(self.run.plant.leg, link): foot.force[:, 2] > LEAST_LOAD
            for link, foot in self.run.feet.items()
        }


def run_function(plant: GroundPlant, name: str, seconds: float, rng: np.random.Generator) -> Episode:
    """Let a machine do one function for about some seconds, with a drawn period and size.

    "squat" is sitting down without a chair, and "swing" walking in the air.
    """
    body = Body.of(plant.leg, plant.soles)
    slower = float(rng.uniform(0.9, 1.15))
    known = {"squat": "sit", "swing": "walk"}.get(name, name)
    options: dict[str, float] = {}
    if known in ("sit", "rise"):
        options = {"seat": SEAT_HEIGHT, "duration": 2.2 * slower}
    elif known in ("walk", "slope"):
        options = {"period": 1.5 * slower, "scale": float(rng.uniform(0.8, 0.95))}
    elif known.startswith("stairs"):
        options = {"riser": RISER, "tread": TREAD, "period": 2.6 * slower}
    if name == "slope":
        options["angle"] = float(rng.uniform(0.05, 0.1))
    function: Function = FUNCTIONS[known](body, **options)
    seconds = max(seconds, function.duration + 1.0)
    time = np.linspace(-LEAD, seconds, round((seconds + LEAD) * KNOTS) + 1)
    phase = _phase(function, time, seconds)
    if name == "squat":  # down and up again
        phase = 0.4 * (1.0 - np.cos(2.0 * np.pi * np.maximum(time, 0.0) / (function.duration + 0.8)))
    flexion, base = _reference(function, phase)
    base[:, 1] += {"stairs down": STEPS * RISER, "swing": 0.4}.get(name, 0.0)
    if name == "squat":
        base[:, 2] += 0.1 * np.sin(2.0 * np.pi * 0.9 * time) * minimum_jerk(time / 2.0)
        for k in range(2):  # feet stay where they are while the torso sways
            flexion[:, k, 0] -= 0.1 * np.sin(2.0 * np.pi * 0.9 * time) * minimum_jerk(time / 2.0)
    if name == "slope":  # the laboratory's axes are those of the ground
        back = np.exp(-1j * options["angle"]) * (base[:, 0] + 1j * base[:, 1])
        base = np.column_stack([back.real, back.imag, base[:, 2] - options["angle"]])
    where = _ground(plant, name, body, options)
    q, support = joint_angles(plant.leg, flexion), 0.2  # share that crutches or a harness bear, an assumption
    feet = {} if name == "swing" else _bearings(where, function, phase, flexion, base)
    motion = planned_motion(where, time, q, base, feet, held=True, borne=1.0 - support)
    lift = (1.0 if name == "swing" else support) * GRAVITY * total_mass(plant) / HARNESS.stiffness[2]
    motion = replace(motion, base=base + np.array([0.0, lift, 0.0]))  # the carriage is above the torso that hangs on it
    run = simulate_on_ground(where, motion, GAINS[plant.leg.limbs[0].chain.n], spring=HARNESS)
    return Episode(function, run, np.interp(run.time, time, phase), scipy.interpolate.CubicSpline(time, q)(run.time))


def _phase(function: Function, time: FloatArray, seconds: float) -> FloatArray:
    """Phase over time: at rest at both ends."""
    if function.name == "stand":
        return np.clip(time / seconds, 0.0, 1.0)
    if not function.cyclic:  # rests half of the remaining time before and after
        return np.clip((time - 0.5 * (seconds - function.duration)) / function.duration, 0.0, 1.0)
    ramp = 1.5
    speed = minimum_jerk((time - 0.3) / ramp) * minimum_jerk((seconds - 0.3 - time) / ramp)
    phase = np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]))) / KNOTS / function.duration
    if function.name.startswith("stairs"):
        most = (STEPS - 2) // 2
        if phase[-1] > most:  # it waits at the end of the stairs
            room = 0.5  # cycles in which it slows down: x − x²/4r ends at r for x = 2r
            x = np.clip(phase - (most - room), 0.0, 2.0 * room)
            return np.minimum(phase, np.minimum(phase, most - room) + x - x * x / (4.0 * room))
    return np.asarray(phase * max(1.0, np.floor(phase[-1])) / phase[-1])


def _ground(plant: GroundPlant, name: str, body: Body, options: Mapping[str, float]) -> GroundPlant:
    """Machine with a seat, beside chair or stairs, or on a slope; without a seat for its calibration."""
    if name in ("squat", "swing"):
        return plant
    blocks: tuple[Block, ...] = ()
    if name in ("sit", "rise"):
        hip = seated_hip(body, SEAT_HEIGHT).real
        blocks = (Block(hip - 0.5, hip + 0.03, SEAT_HEIGHT),)
    elif name == "stairs up":
        blocks = tuple(Block((j - 0.5) * TREAD, (STEPS + 2) * TREAD, j * RISER) for j in range(1, STEPS + 1))
    elif name == "stairs down":
        blocks = tuple(Block(-2.0, (j + 0.5) * TREAD, (STEPS - j) * RISER) for j in range(STEPS))
    soles = {**plant.soles, plant.root_link: SEAT_SOLE}
    return replace(plant, soles=soles, blocks=blocks, ground_lean=options.get("angle", 0.0))


def _reference(function: Function, phase: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Flexion and torso at phases; each cycle of a cyclic function begins where the last one ended."""
    within = np.where(phase < 1.0, phase, phase % 1.0 if function.cyclic else 1.0)
    flexion = scipy.interpolate.CubicSpline(PHASE, function.flexion)(within)
    base = scipy.interpolate.CubicSpline(PHASE, function.torso)(within)
    if function.cyclic:
        base = base + np.floor(phase)[:, None] * (function.torso[-1] - function.torso[0])
    return np.asarray(flexion), np.asarray(base)


def _bearings(
    plant: GroundPlant, function: Function, phase: FloatArray, flexion: FloatArray, base: FloatArray
) -> dict[str, Bearing]:
    """Plan which contacts bear the machine, and with which point of their sole."""
    out, body = {}, Body.of(plant.leg, plant.soles)
    expected = [function.expected(p) for p in phase]
    for link, sole in plant.soles.items():
        name = contact_name(plant.leg, link)
        share = scipy.ndimage.gaussian_filter1d(np.array([float(name in each) for each in expected]), 0.04 * KNOTS)
        point = np.broadcast_to(sole.centre, (len(phase), 3))
        if name != SEAT:
            places = body.sole(base[:, 0] + 1j * base[:, 1], base[:, 2], flexion[:, SIDES.index(name)])
            weight = np.exp(-(places.imag - places.imag.min(axis=1, keepdims=True)) / 0.01)
            ends = sole.points[[int(np.argmin(sole.points[:, 0])), int(np.argmax(sole.points[:, 0]))]]
            point = weight @ ends / weight.sum(axis=1, keepdims=True)
        out[link] = Bearing(np.clip(share, 1e-3, 1.0), point)
    return out


def run_day(
    plant: GroundPlant, seconds: float = 180.0, seed: int = 0, progress: Callable[[float], None] | None = None
) -> list[Episode]:
    """Run the functions of a day one after another.

    Args:
        plant: The machine.
        seconds: Duration of the day [s].
        seed: Seed of periods and sizes.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        The episodes.

    Raises:
        ExoidError: MuJoCo is not installed, the day is shorter than 30 s, or a motion cannot be followed.
    """
    if not 30.0 <= seconds <= 600.0:
        raise BadArgumentError(f"a day of {seconds:g} s", remedy="take 30 to 600 s")
    rng, out = np.random.default_rng(seed), []
    for k, (name, share) in enumerate(PLAN):
        out.append(run_function(plant, name, share * seconds, rng))
        if progress is not None:
            progress((k + 1) / len(PLAN))
    return out
