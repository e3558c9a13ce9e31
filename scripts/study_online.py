"""Recursive estimation on the virtual rig: payload, friction, rest, hours without a change, and inside the loop.

    python scripts/study_online.py payload --seeds 16     # 1.5 kg on the shank: its mass 5 s later, P95 of the errors
    python scripts/study_online.py standing               # ten minutes at rest: does a parameter move?
    python scripts/study_online.py friction --seeds 16    # Coulomb and viscous friction of each joint doubles
    python scripts/study_online.py quiet --minutes 60     # moving without any change: false alarms
    python scripts/study_online.py loop --seeds 16        # the payload again, with a controller that uses the estimate
    python scripts/study_online.py memory --minutes 30    # memory of 30 min at 500 Hz, and time of a step

``--scene NAME`` takes another leg, motion or rig (``--scene all``: every one); without it, three segments of BLEEX walk
under PD control at 500 Hz, with friction, encoders of 65 536 counts, and torque sensors with noise, which see the mean
of the torques held before and after a sample. The estimator knows the geometry, and what the first half minute says.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
import tracemalloc
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

import exoid
from exoid._typing import FloatArray
from exoid.control import ControlModel, default_gains, feedforward_pd, mean_pose, self_tuning
from exoid.control.law import AnyLaw
from exoid.online import RecursiveEstimator, load_change
from exoid.rig import Plant, plant_with_payloads

sys.path.insert(0, str(Path(__file__).resolve().parent))
from online_scenes import SCENES, Machine, Scene, Stream, scene

PAYLOAD = exoid.Payload("knee", 1.5, (0.0, 0.0, -0.2))
WARM = 36.0
"""Time before something changes [s]."""
SHORT = 4.0
"""Time for which controllers move before the payload that need not learn the leg without it [s]."""


def feed(online: RecursiveEstimator, stream: Stream, rig: int) -> None:
    """Let an estimator take all samples of one rig in."""
    online.update(stream.q[..., rig], None, None, stream.tau[..., rig])


class Found(NamedTuple):
    """What was detected, and after how long [s]; the error of the mass and its standard deviation [kg]."""

    detected: str
    after: float
    error: float = np.nan
    std: float = np.nan


def first_change(online: RecursiveEstimator, before: Stream, rate: float) -> Found:
    """First change that was detected."""
    if not online.changes:
        return Found("none", np.nan)
    event = online.changes[0]
    return Found(f"{event.kind} at {event.joint}", event.time - len(before.q) / rate)


def payload(seeds: int, where: str = "walk", before: float = WARM, after: float = 5.0) -> list[Found]:
    """Strap the payload on, and estimate its mass so much later."""
    at = scene(where)
    plain, machine = at.plants(seeds), Machine(at, seeds, 1)
    first, loaded = machine.walk(plain, before), machine.walk(plant_with_payloads(plain, (PAYLOAD,)), after)
    found = []
    for rig in range(seeds):
        online = at.estimator()
        feed(online, first, rig)
        known = online.estimate
        feed(online, loaded, rig)
        change = load_change(known, online.estimate, "knee", PAYLOAD.position)
        found.append(first_change(online, first, at.rate)._replace(error=change.mass - PAYLOAD.mass, std=change.std))
    return found


def friction(
    seeds: int, joints: Sequence[str], where: str = "walk", before: float = WARM, after: float = 4.0
) -> dict[str, list[Found]]:
    """Double the friction of a joint, on so many rigs for each of the joints."""
    at = scene(where)
    count = seeds * len(joints)
    machine = Machine(at, count, 3)
    first = machine.walk(at.plants(count), before)
    doubled = [at.plants(seeds, {f"c0_{joint}": 2.0, f"d_{joint}": 2.0}) for joint in joints]
    then = machine.walk(Plant.concatenate(doubled), after)
    found: dict[str, list[Found]] = {joint: [] for joint in joints}
    for rig in range(count):
        online = at.estimator()
        feed(online, first, rig)
        feed(online, then, rig)
        found[joints[rig // seeds]].append(first_change(online, first, at.rate))
    return found


def standing(minutes: float = 10.0, seed: int = 5) -> FloatArray:
    """Walk, stand, and return how far each parameter moved while standing, in standard deviations, (P,)."""
    at = scene("walk")
    one, machine, online = at.plants(), Machine(at, 1, seed), at.estimator()
    feed(online, machine.walk(one, WARM), 0)
    feed(online, machine.stand(one, 1.0), 0)  # the last steps pass the filters
    before = online.estimate
    for _ in range(max(1, round(6.0 * minutes))):
        feed(online, machine.stand(one, 10.0), 0)
    return np.asarray(np.abs(online.estimate.values - before.values) / before.std)


class Quiet(NamedTuple):
    """False alarms: changes that were reported, and how long the rigs moved [h]."""

    changes: tuple[str, ...]
    hours: float

    def __str__(self) -> str:
        """Write one line."""
        alarms = ", ".join(self.changes) or "none"
        return f"{60.0 * self.hours:.0f} min without a change: {len(self.changes) / self.hours:.2f} an hour ({alarms})"


def quiet(minutes: float, where: str = "walk", seed: int = 9, rigs: int = 10) -> Quiet:
    """Move without any change, so many minutes in all, shared among rigs."""
    at = scene(where)
    plant, machine = at.plants(rigs), Machine(at, rigs, seed)
    online = [at.estimator() for _ in range(rigs)]
    each = minutes / rigs
    for _ in range(max(1, round(each))):
        stream = machine.walk(plant, 60.0 * min(each, 1.0))
        for rig, estimator in enumerate(online):
            feed(estimator, stream, rig)
    changes = tuple(f"{c.kind} at {c.joint}" for one in online for c in one.changes)
    return Quiet(changes, minutes / 60.0)


class Loop(NamedTuple):
    """A controller behind the change: error of the mass [kg], (B,); RMS and peak tracking errors [deg], (n, B)."""

    mass: FloatArray
    rms: FloatArray
    peak: FloatArray


def loop(seeds: int, where: str = "walk", after: float = 5.0, measured: float = 6.0) -> dict[str, Loop]:
    """Strap the payload on while a controller with soft gains walks; its errors from so much later on.

    Self-tuning begins with the parameters of the leg without the payload.
    Noise of sensors and drives is the same for all controllers from the change on.
    """
    at = scene(where)
    plain = at.plants(seeds)
    loaded = plant_with_payloads(plain, (PAYLOAD,))
    light, heavy = (ControlModel.of(plant.take([0])) for plant in (plain, loaded))
    kp, kd = default_gains(light, mean_pose(at.motion, 12.0))
    tuning = self_tuning(light, kp, kd, rate=at.rate)
    laws: dict[str, AnyLaw] = {
        "feedforward, uninformed": feedforward_pd(light, kp, kd, rate=at.rate),
        "feedforward that knew": feedforward_pd(heavy, kp, kd, rate=at.rate),
        "self-tuning": tuning,
    }
    found = {}
    for name, law in laws.items():
        early = WARM - SHORT if name != "self-tuning" else 0.0
        machine, mass = Machine(at, seeds, 11, early), np.full(seeds, np.nan)
        machine.drive(plain, law, WARM - early)
        machine.reseed(12)
        before = machine.memory
        machine.drive(loaded, law, after)
        if name == "self-tuning":
            pairs = [[tuning.estimate_of(memory, rig) for memory in (before, machine.memory)] for rig in range(seeds)]
            mass = np.array([load_change(a, b, "knee", PAYLOAD.position).mass - PAYLOAD.mass for a, b in pairs])
        error = np.rad2deg(machine.drive(loaded, law, measured).error)
        found[name] = Loop(mass, np.sqrt((error**2).mean(axis=0)), np.abs(error).max(axis=0))
    return found


def print_loop(found: dict[str, Loop], at: Scene) -> None:
    """Print errors, and their ratios to those of the controller that knew."""
    print(f"{'':24}{'rms [deg]':>24}{'peak [deg]':>24}   mean over seeds, {', '.join(at.leg.joint_labels)}")
    for name, one in found.items():
        cells = ["".join(f"{x:8.3f}" for x in values.mean(axis=1)) for values in (one.rms, one.peak)]
        print(f"{name:24}{cells[0]:>24}{cells[1]:>24}")
    for kind in ("rms", "peak"):
        ratio = getattr(found["self-tuning"], kind) / getattr(found["feedforward that knew"], kind)
        each = "".join(f"{x:7.2f}" for x in np.quantile(ratio, 0.95, axis=1))
        print(f"self-tuning over feedforward that knew, {kind}, P95 of {ratio.shape[1]}:{each}")
    errors = np.abs(found["self-tuning"].mass)
    print(f"payload of {PAYLOAD.mass} kg, 5 s later: P95 of the errors {np.quantile(errors, 0.95):.3f} kg")


class Cost(NamedTuple):
    """Memory over time, and time of a step and of one call of ``pin.rnea`` [s].

    Attributes:
        resident: Resident memory of the process at the beginning, and after each tenth [bytes].
        traced: Memory of Python's objects in a second run [bytes], likewise.
    """

    resident: tuple[int, ...]
    traced: tuple[int, ...]
    step: float
    longest: float
    rnea: float


def resident() -> int:
    """Resident memory of this process [bytes]; 0 where the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def cost(minutes: float) -> Cost:
    """Update with walking sample by sample, and measure memory and processor time."""
    at = scene("walk")
    stream = Machine(at, 1, 7).walk(at.plants(), 12.0)
    q, tau = stream.q[..., 0], stream.tau[..., 0]
    online = at.estimator()
    online.update(q, None, None, tau)
    count = round(minutes * 60.0 * at.rate)
    data, model = at.leg.model.createData(), at.leg.model
    begin = time.process_time()
    for k in range(20_000):
        pin.rnea(model, data, q[k % len(q)], q[0], q[0])
    rnea = (time.process_time() - begin) / 20_000
    begin = time.process_time()
    for k in range(20_000):
        online.update(q[k % len(q)], None, None, tau[k % len(q)])
    step, longest = (time.process_time() - begin) / 20_000, 0.0
    for k in range(2_000):
        before = time.process_time()
        online.update(q[k % len(q)], None, None, tau[k % len(q)])
        longest = max(longest, time.process_time() - before)

    def curve(read: Callable[[], int]) -> tuple[int, ...]:
        readings = []
        for tenth in range(11):
            gc.collect()
            readings.append(read())
            for k in range(count // 10 if tenth < 10 else 0):
                online.update(q[k % len(q)], None, None, tau[k % len(q)])
        return tuple(readings)

    of_process = curve(resident)
    tracemalloc.start()
    for k in range(len(q)):  # what is allocated before is not traced
        online.update(q[k], None, None, tau[k])
    of_python = curve(lambda: tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    return Cost(of_process, of_python, step, longest, rnea)


def print_cost(found: Cost, minutes: float) -> None:
    """Print memory and time."""
    for name, curve, size in (("resident", found.resident, 1e6), ("traced", found.traced, 1e3)):
        unit = "MB" if size == 1e6 else "kB"
        line = " ".join(f"{x / size:.1f}" for x in curve)
        print(f"{name} memory over {minutes:g} min, every {minutes / 10.0:g} min [{unit}]: {line}")
    print(
        f"a step takes {1e6 * found.step:.1f} µs on average and {1e3 * found.longest:.2f} ms at most, one pin.rnea "
        f"{1e6 * found.rnea:.2f} µs: {found.step / found.rnea:.0f} ×"
    )


def print_study(name: str, where: str, given: argparse.Namespace) -> None:
    """Run one study on one scene, and print it."""
    print(f"{name}, {where}:", flush=True)
    if name == "payload":
        masses = payload(given.seeds, where)
        errors = np.abs([one.error for one in masses])
        latest = max(one.after for one in masses)
        kinds = ", ".join(sorted({one.detected for one in masses}))
        print(f"  P95 of the errors of {PAYLOAD.mass} kg, 5 s later: {np.quantile(errors, 0.95):.3f} kg")
        print(f"  {kinds}, {latest:.2f} s later at most")
    elif name == "friction":
        for joint, each in friction(given.seeds, scene(where).leg.joint_labels, where).items():
            kinds = ", ".join(sorted({one.detected for one in each}))
            print(f"  {joint}: {kinds}, {max(one.after for one in each):.2f} s later at most")
    elif name == "quiet":
        print(f"  {quiet(given.minutes or 60.0, where, rigs=given.rigs)}", flush=True)
    else:
        print_loop(loop(given.seeds, where, measured=given.measured), scene(where))


def main() -> None:
    """Read the command line, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = ("payload", "friction", "standing", "quiet", "loop", "memory")
    parser.add_argument("study", choices=names)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--minutes", type=float, default=None)
    parser.add_argument("--measured", type=float, default=6.0, help="time over which tracking errors count [s]")
    parser.add_argument("--rigs", type=int, default=10, help="rigs among which quiet minutes are shared")
    parser.add_argument("--scene", default="walk", choices=(*SCENES, "all"))
    given = parser.parse_args()
    if given.study == "standing":
        moved = standing(given.minutes or 10.0)
        print(f"standing still: the parameter that moved most moved by {moved.max():.3g} standard deviations")
    elif given.study == "memory":
        minutes = given.minutes or 30.0
        print_cost(cost(minutes), minutes)
    else:
        for where in SCENES if given.scene == "all" else (given.scene,):
            print_study(given.study, where, given)


if __name__ == "__main__":
    main()
