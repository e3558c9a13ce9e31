"""Recursive estimation on the virtual rig: a payload while walking, standing still, friction that doubles, an hour.

    python scripts/study_online.py payload --seeds 16     # 1.5 kg on the shank: its mass 5 s later, P95 of the errors
    python scripts/study_online.py standing               # ten minutes at rest: does a parameter move?
    python scripts/study_online.py friction --seeds 16    # Coulomb and viscous friction of one joint doubles
    python scripts/study_online.py quiet --minutes 60     # walking without any change: false alarms
    python scripts/study_online.py memory --minutes 30    # memory of 30 min at 500 Hz, and time of a step

The three segments of BLEEX walk on the rig, under PD control at 500 Hz, with friction, encoders of 65 536 counts, and
torque sensors with noise, which see the mean of the torques held before and after a sample. The estimator knows the
geometry, and what the first half minute says.
"""

from __future__ import annotations

import argparse
import gc
import time
import tracemalloc
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

import exoid
from exoid._typing import FloatArray
from exoid.experiments import gait_for_leg, norm_gait
from exoid.experiments.references import Hold
from exoid.online import RecursiveEstimator, load_change
from exoid.rig import PlanarStepper, Plant, ProportionalDerivative, Sensors, plant_with_payloads
from exoid.rig.controllers import Reference

RATE = 500.0
PERIOD = 1.2
STEP = 1e-3
SETTLING = 1.0
"""Time from which on readings count [s]."""
FRICTION = {"c0_hip": 2.0, "c0_knee": 1.5, "c0_ankle": 0.8, "d_hip": 0.5, "d_knee": 0.3, "d_ankle": 0.2}
TORQUE_NOISE = (0.5, 0.4, 0.2)
GAINS = (np.array([[600.0], [400.0], [150.0]]), np.array([[25.0], [15.0], [4.0]]))
PAYLOAD = exoid.Payload("knee", 1.5, (0.0, 0.0, -0.2))
TERMS = (exoid.Coulomb(), exoid.Viscous())


class Stream(NamedTuple):
    """Readings of B rigs, (N, n, B)."""

    q: FloatArray
    tau: FloatArray


def leg() -> exoid.Leg:
    """The leg."""
    return exoid.load_leg("bleex", inertias="cad")


class Machine:
    """Rigs under PD control that go on from piece to piece, whatever changes between two samples."""

    def __init__(self, plant: Plant, seed: int) -> None:
        """Begin in the stride."""
        self.gait = gait_for_leg(plant.leg, norm_gait("Free", period=PERIOD))
        torque_noise = np.array(TORQUE_NOISE)[:, None]
        self._rng, self._sensors = np.random.default_rng(seed), Sensors(torque_noise=torque_noise)
        start = self.gait.at(0.0)
        self._q, self._v = (np.tile(x, (1, plant.count)) for x in (start.q, start.v))
        self._torque, self._done = np.zeros_like(self._q), 0
        self.walk(plant, SETTLING)

    def walk(self, plant: Plant, seconds: float) -> Stream:
        """Walk for so long."""
        return self.go(plant, self.gait, seconds)

    def stand(self, plant: Plant, seconds: float) -> Stream:
        """Stand still in the pose in which the stride begins."""
        return self.go(plant, Hold(self.gait.at(0.0).q), seconds)

    def go(self, plant: Plant, reference: Reference, seconds: float) -> Stream:
        """Follow a motion for so long."""
        controller, rig, samples = ProportionalDerivative(*GAINS), PlanarStepper(plant, self._q, self._v, STEP), []
        for _ in range(round(seconds * RATE)):
            reading = self._sensors.angle(rig.q, self._rng)
            before, self._torque = self._torque, controller.command(reference.at(self._done / RATE), reading, rig.v)
            samples.append((reading, self._sensors.torque(0.5 * (before + self._torque), self._rng)))
            for _ in range(round(1.0 / (RATE * STEP))):
                rig.step(self._torque, np.zeros_like(self._torque))
            self._done += 1
        self._q, self._v = rig.q, rig.v
        return Stream(*(np.array(x) for x in zip(*samples, strict=True)))


def plants(count: int, friction: Mapping[str, float] = FRICTION) -> Plant:
    """So many equal rigs."""
    return Plant.build(leg(), friction, end_stops=False).repeat(count)


def feed(online: RecursiveEstimator, stream: Stream, rig: int) -> None:
    """Let an estimator take all samples of one rig in."""
    online.update(stream.q[..., rig], None, None, stream.tau[..., rig])


class PayloadError(NamedTuple):
    """Error of the mass that was found [kg], its standard deviation, and what was detected after how long [s]."""

    error: float
    std: float
    detected: str
    after: float


def payload(seeds: int, before: float = 36.0, after: float = 5.0) -> list[PayloadError]:
    """Strap the payload on, and estimate its mass so much later."""
    plain = plants(seeds)
    machine = Machine(plain, 1)
    first, loaded = machine.walk(plain, before), machine.walk(plant_with_payloads(plain, (PAYLOAD,)), after)
    found = []
    for rig in range(seeds):
        online = RecursiveEstimator(leg(), TERMS, rate=RATE)
        feed(online, first, rig)
        known = online.estimate
        feed(online, loaded, rig)
        change = load_change(known, online.estimate, "knee", PAYLOAD.position)
        event = online.changes[0] if online.changes else None
        name = "none" if event is None else f"{event.kind} at {event.joint}"
        late = np.nan if event is None else event.time - len(first.q) / RATE
        found.append(PayloadError(change.mass - PAYLOAD.mass, change.std, name, late))
    return found


class FrictionError(NamedTuple):
    """What was detected after friction doubled, and after how long [s]."""

    detected: str
    after: float


def friction(seeds: int, joint: str = "knee", before: float = 36.0, after: float = 4.0) -> list[FrictionError]:
    """Double the friction of one joint."""
    doubled = {name: value * (2.0 if name.endswith(joint) else 1.0) for name, value in FRICTION.items()}
    machine = Machine(plants(seeds), 3)
    first, then = machine.walk(plants(seeds), before), machine.walk(plants(seeds, doubled), after)
    found = []
    for rig in range(seeds):
        online = RecursiveEstimator(leg(), TERMS, rate=RATE)
        feed(online, first, rig)
        feed(online, then, rig)
        event = online.changes[0] if online.changes else None
        name = "none" if event is None else f"{event.kind} at {event.joint}"
        found.append(FrictionError(name, np.nan if event is None else event.time - len(first.q) / RATE))
    return found


def standing(minutes: float = 10.0, seed: int = 5) -> FloatArray:
    """Walk, stand, and return how far each parameter moved while standing, in standard deviations, (P,)."""
    one = plants(1)
    machine, online = Machine(one, seed), RecursiveEstimator(leg(), TERMS, rate=RATE)
    feed(online, machine.walk(one, 36.0), 0)
    feed(online, machine.stand(one, 1.0), 0)  # the last steps pass the filters
    before = online.estimate
    for _ in range(round(minutes)):
        feed(online, machine.stand(one, 60.0), 0)
    return np.asarray(np.abs(online.estimate.values - before.values) / before.std)


def quiet(minutes: float, seed: int = 9, rigs: int = 10) -> int:
    """Walk without any change, so many minutes in all, shared among rigs: number of changes that are reported."""
    plant = plants(rigs)
    machine = Machine(plant, seed)
    online = [RecursiveEstimator(leg(), TERMS, rate=RATE) for _ in range(rigs)]
    for _ in range(max(1, round(minutes / rigs))):
        stream = machine.walk(plant, 60.0)
        for rig, estimator in enumerate(online):
            feed(estimator, stream, rig)
    return sum(len(estimator.changes) for estimator in online)


class Cost(NamedTuple):
    """Memory that updates add [bytes], time of a step and of one call of ``pin.rnea`` [s]."""

    memory: int
    step: float
    longest: float
    rnea: float


def cost(minutes: float) -> Cost:
    """Update with walking sample by sample, and measure memory and processor time."""
    stream = Machine(plants(1), 7).walk(plants(1), 12.0)
    q, tau = stream.q[..., 0], stream.tau[..., 0]
    online = RecursiveEstimator(leg(), TERMS, rate=RATE)
    online.update(q, None, None, tau)
    count, longest = round(minutes * 60.0 * RATE), 0.0
    data, model = leg().model.createData(), leg().model
    begin = time.process_time()
    for k in range(20_000):
        pin.rnea(model, data, q[k % len(q)], q[0], q[0])
    rnea = (time.process_time() - begin) / 20_000
    begin = time.process_time()
    for k in range(20_000):
        online.update(q[k % len(q)], None, None, tau[k % len(q)])
    step = (time.process_time() - begin) / 20_000
    for k in range(2_000):
        before = time.process_time()
        online.update(q[k % len(q)], None, None, tau[k % len(q)])
        longest = max(longest, time.process_time() - before)
    tracemalloc.start()
    for k in range(len(q)):  # what is allocated before is not traced
        online.update(q[k], None, None, tau[k])
    gc.collect()
    before_bytes, _ = tracemalloc.get_traced_memory()
    for k in range(count):
        online.update(q[k % len(q)], None, None, tau[k % len(q)])
    gc.collect()
    after_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return Cost(after_bytes - before_bytes, step, longest, rnea)


def main() -> None:
    """Read the command line, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=("payload", "friction", "standing", "quiet", "memory"))
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--minutes", type=float, default=None)
    parser.add_argument("--joint", default="knee", choices=("hip", "knee", "ankle"))
    given = parser.parse_args()
    if given.study == "payload":
        masses = payload(given.seeds)
        errors = np.abs([one.error for one in masses])
        for one in masses:
            print(f"error {one.error:+.3f} kg, std {one.std:.3f} kg, {one.detected} after {one.after:.2f} s")
        print(f"payload of {PAYLOAD.mass} kg, 5 s later: P95 of the errors {np.quantile(errors, 0.95):.3f} kg")
    elif given.study == "friction":
        for of_seed in friction(given.seeds, given.joint):
            print(f"{of_seed.detected} after {of_seed.after:.2f} s")
    elif given.study == "standing":
        moved = standing(given.minutes or 10.0)
        print(f"standing still: the parameter that moved most moved by {moved.max():.3g} standard deviations")
    elif given.study == "quiet":
        minutes = given.minutes or 60.0
        print(f"{quiet(minutes)} changes reported in {minutes:g} min without a change")
    else:
        minutes = given.minutes or 30.0
        found = cost(minutes)
        print(f"{minutes:g} min at {RATE:g} Hz: memory grew by {found.memory} bytes")
        print(
            f"a step takes {1e6 * found.step:.1f} µs on average and {1e3 * found.longest:.2f} ms at most, one pin.rnea "
            f"{1e6 * found.rnea:.2f} µs: {found.step / found.rnea:.0f} ×"
        )


if __name__ == "__main__":
    main()
