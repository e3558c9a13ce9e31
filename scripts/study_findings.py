"""Which faults of a log does ``exoid.check`` find, and how often does it find one in a log without any?

A log is a motion of five harmonics with exact torques of Pinocchio, sharp Coulomb and viscous friction, white and
coloured torque noise and quantised angles. Each corruption has three sizes. A case counts where the corruption moves
some parameter by more than its 95 % interval; then the share of logs is printed in which the right kind was found at
the right joint. Clean logs give the share of false alarms.

    OMP_NUM_THREADS=1 python scripts/study_findings.py                                   # a few minutes
    OMP_NUM_THREADS=1 python scripts/study_findings.py --seeds 20 --clean 500 --workers 8  # the full table
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

import exoid
from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.torso import TorsoMotion

RATE, SECONDS = 100.0, 40.0
QUANTUM = 2.0 * np.pi / 2**16
"""Of the angles [rad]."""
SHARPNESS = 0.01
"""Width of the friction that is simulated [rad/s]; the model's is wider."""
LEGS = ("bleex", "cuhk", "hyq")


class Log(NamedTuple):
    """Leg and recordings as they reach exoid."""

    leg: exoid.Leg
    recordings: tuple[exoid.Recording, ...]


class Corruption(NamedTuple):
    """A fault in three sizes.

    Attributes:
        name: Name in the table.
        kinds: Kinds of findings that name it.
        joint: Index of the joint that is to be named; None where any joint is right.
        sizes: Sizes, small to large.
        apply: Function of a clean log, the size and a generator.
    """

    name: str
    kinds: tuple[str, ...]
    joint: int | None
    sizes: tuple[float, ...]
    apply: Callable[[Log, float, np.random.Generator], Log]


class Outcome(NamedTuple):
    """One log: whether a parameter moved out of its interval, and whether the fault was named."""

    moved: bool
    found: bool
    kinds: tuple[str, ...]


@cache
def leg_of(name: str) -> exoid.Leg:
    """Load a leg of the catalog, or a leg of HyQ from example-robot-data."""
    if name != "hyq":
        return exoid.load_leg(name)
    from example_robot_data.robots_loader import ROBOTS, getModelPath  # noqa: PLC0415 - only for this leg

    loader = ROBOTS["hyq"]
    inside = Path(loader.path) / loader.urdf_subpath / loader.urdf_filename
    path = Path(getModelPath(str(inside))) / inside
    return exoid.Leg.from_urdf(path, ("lf_haa_joint", "lf_hfe_joint", "lf_kfe_joint"))


def clean_log(name: str, seed: int, *, velocity: bool = False, torso: float = 0.0) -> Log:
    """Simulate a log without faults."""
    leg, rng = leg_of(name), np.random.default_rng(seed)
    n = len(leg.joint_names)
    time = np.arange(int(SECONDS * RATE)) / RATE
    omega = 2.0 * np.pi * 0.1 * np.array([1.0, 2.0, 3.0, 5.0, 7.0])
    amplitude = 0.5 * rng.uniform(0.4, 1.0, (n, 5)) / np.array([1.0, 1.2, 1.5, 2.5, 3.5])
    phase = np.multiply.outer(time, omega)[:, None, :] + rng.uniform(0.0, 2.0 * np.pi, (n, 5))
    q, v = (amplitude * np.sin(phase)).sum(-1), (amplitude * omega * np.cos(phase)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(phase)).sum(-1)
    middle = np.array([0.3, -0.6, 0.1])[:n]
    tilt = None if torso == 0.0 else TorsoMotion(pitch=torso)
    tau = leg.inverse_dynamics(q + middle, v, a, tilt)
    size = np.sqrt(np.mean(tau**2, axis=0))
    tau = tau + 0.06 * size * np.tanh(v / SHARPNESS) + 0.03 * size * v
    white = rng.standard_normal(tau.shape)
    coloured = scipy.signal.lfilter([np.sqrt(1.0 - 0.82**2)], [1.0, -0.82], rng.standard_normal(tau.shape), axis=0)
    tau = tau + size * (0.01 * white + 0.005 * coloured)
    measured = QUANTUM * np.round((q + middle) / QUANTUM)
    log = exoid.Recording(
        time=time, q=measured, v=v if velocity else None, tau=tau, joint_names=leg.joint_names, largest_angle=np.inf
    )
    return Log(leg, (log,))


def changed(log: Log, **arrays: object) -> Log:
    """Replace arrays of the only recording."""
    return log._replace(recordings=(replace(log.recordings[0], **arrays),))


def torque(change: Callable[[FloatArray, float, np.random.Generator], FloatArray], joint: int | None) -> Callable:
    """Corrupt the torque of one joint, or of all."""

    def apply(log: Log, size: float, rng: np.random.Generator) -> Log:
        tau = np.array(log.recordings[0].tau)
        for k in range(tau.shape[1]) if joint is None else (joint,):
            tau[:, k] = change(tau[:, k], size, rng)
        return changed(log, tau=tau)

    return apply


def angle(change: Callable[[FloatArray, float, np.random.Generator], FloatArray], joint: int | None) -> Callable:
    """Corrupt the angle of one joint, or of all."""

    def apply(log: Log, size: float, rng: np.random.Generator) -> Log:
        q = np.array(log.recordings[0].q)
        for k in range(q.shape[1]) if joint is None else (joint,):
            q[:, k] = change(q[:, k], size, rng)
        return changed(log, q=q)

    return apply


def late(x: FloatArray, seconds: float, _: np.random.Generator) -> FloatArray:
    """Delay a signal."""
    t = np.arange(len(x)) / RATE
    return scipy.interpolate.CubicSpline(t, x)(np.clip(t - seconds, 0.0, None))


def frozen(x: FloatArray, seconds: float, rng: np.random.Generator) -> FloatArray:
    """Freeze a signal for a while."""
    x, count = x.copy(), int(seconds * RATE)
    start = int(rng.integers(len(x) // 4, 3 * len(x) // 4 - min(count, len(x) // 4)))
    x[start : start + count] = x[start]
    return x


def at_random(share: float, x: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Choose samples."""
    return rng.random(len(x)) < share


def clipped(x: FloatArray, part: float, _: np.random.Generator) -> FloatArray:
    """Clip at a part of the largest torque."""
    limit = part * np.abs(x).max()
    return np.clip(x, -limit, limit)


def clipped_above(x: FloatArray, part: float, _: np.random.Generator) -> FloatArray:
    """Clip on one side, at a part of the way from the median to the largest torque."""
    return np.minimum(x, np.median(x) + part * (x.max() - np.median(x)))


def held(x: FloatArray, samples: float, _: np.random.Generator) -> FloatArray:
    """Repeat values, as those of a slower bus."""
    return x[(np.arange(len(x)) // int(samples)) * int(samples)]


def dropped(x: FloatArray, share: float, rng: np.random.Generator) -> FloatArray:
    """Lose samples to zero."""
    return np.where(at_random(share, x, rng), 0.0, x)


def spiked(x: FloatArray, share: float, rng: np.random.Generator) -> FloatArray:
    """Add one-sided spikes."""
    return x + at_random(share, x, rng) * 3.0 * np.std(x)


def gapped(log: Log, seconds: float, rng: np.random.Generator) -> Log:
    """Lose samples at one instant at which joints move, and stamp the others anew."""
    one, count = log.recordings[0], round(seconds * RATE)
    speed = np.abs(np.gradient(one.q, axis=0)).sum(axis=1)
    fast = np.flatnonzero(speed > np.quantile(speed, 0.6))
    start = int(rng.choice(fast[(fast > 400) & (fast < len(speed) - 400)]))
    keep = np.delete(np.arange(len(one)), np.s_[start : start + count])
    return changed(log, time=one.time[: len(keep)], q=one.q[keep], tau=one.tau[keep])


def swapped(log: Log, which: float, _: np.random.Generator) -> Log:
    """Swap torques (0), angles (1) or both (2) of the first two joints."""
    one, order = log.recordings[0], [1, 0, *range(2, len(log.leg.joint_names))]
    arrays = {"tau": one.tau[:, order]} if which != 1.0 else {}
    return changed(log, **arrays, **({"q": one.q[:, order]} if which > 0.0 else {}))


def tilted(log: Log, degrees: float, _: np.random.Generator) -> Log:
    """Tilt the base; of a leg that is not planar turn gravity in the model."""
    if log.leg.chain is not None:
        q = np.array(log.recordings[0].q)
        q[:, 0] -= np.deg2rad(degrees)
        return changed(log, q=q)
    model, angle_ = log.leg.model.copy(), np.deg2rad(degrees)
    model.gravity.linear = 9.81 * np.array([np.sin(angle_), 0.0, -np.cos(angle_)])
    one = log.recordings[0]
    upright = exoid.dynamics.gravity_torque(log.leg.model, one.q)
    return changed(log, tau=one.tau + exoid.dynamics.gravity_torque(model, one.q) - upright)


def longer(log: Log, part: float, _: np.random.Generator) -> Log:
    """Make the first segment of a planar leg longer in the model."""
    if log.leg.chain is None:
        raise ExoidError("not a planar leg")
    offsets = log.leg.chain.offsets.copy()
    offsets[0] *= 1.0 + part
    return log._replace(leg=replace(log.leg, chain=replace(log.leg.chain, offsets=offsets)))


def strapped(log: Log, stiffness: float, _: np.random.Generator) -> Log:
    """Tie the last joint to the frame by a strap that pulls only [N/m]."""
    one, leg, step = log.recordings[0], log.leg, 1e-5
    ends = leg.forward_kinematics(one.q).translation
    anchor = ends[:, 0].mean(axis=0) + np.array([0.4, 0.0, -0.1])
    stretch = np.linalg.norm(ends[:, -1] - anchor, axis=1)
    pull = stiffness * np.clip(stretch - np.quantile(stretch, 0.2), 0.0, None)
    tau = np.array(one.tau)
    for k in range(tau.shape[1]):
        moved = np.array(one.q)
        moved[:, k] += step
        further = np.linalg.norm(leg.forward_kinematics(moved).translation[:, -1] - anchor, axis=1)
        tau[:, k] += pull * (further - stretch) / step
    return changed(log, tau=tau)


def spring(log: Log, part: float, _: np.random.Generator) -> Log:
    """Add a spring at the second joint, a part of its RMS torque per radian."""
    one, tau = log.recordings[0], np.array(log.recordings[0].tau)
    tau[:, 1] += part * np.std(tau[:, 1]) * (one.q[:, 1] + 0.3)
    return changed(log, tau=tau)


def mixed(log: Log, part: float, _: np.random.Generator) -> Log:
    """Let the second sensor see the first torque."""
    tau = np.array(log.recordings[0].tau)
    tau[:, 1] += part * tau[:, 0]
    return changed(log, tau=tau)


def other_friction(log: Log, form: float, _: np.random.Generator) -> Log:
    """Add Stribeck (0), quadratic (1) or load-dependent (2) friction at the second joint."""
    one, tau = log.recordings[0], np.array(log.recordings[0].tau)
    v = np.gradient(one.q[:, 1]) * RATE
    size, direction = np.std(tau[:, 1]), np.tanh(v / 0.05)
    stribeck, square = direction * np.exp(-((v / 0.3) ** 2)), v * np.abs(v) / np.std(v) ** 2
    forms = (stribeck, square, direction * np.abs(tau[:, 1]) / size)
    tau[:, 1] += 0.08 * size * forms[int(form)]
    return changed(log, tau=tau)


def late_velocity(log: Log, seconds: float, rng: np.random.Generator) -> Log:
    """Log a velocity of the second joint that is late."""
    one = log.recordings[0]
    v = np.gradient(one.q, axis=0) * RATE
    v[:, 1] = late(v[:, 1], seconds, rng)
    return changed(log, v=v)


def twice(log: Log, share: float, _: np.random.Generator) -> Log:
    """Pass a part of a log again."""
    one = log.recordings[0]
    return log._replace(recordings=(one, one.slice(0, int(share * len(one)))))


def in_degrees(log: Log, joint: float, _: np.random.Generator) -> Log:
    """Write the angles of one joint, or of all (−1), in degrees."""
    q = np.array(log.recordings[0].q)
    columns = slice(None) if joint < 0 else slice(int(joint), int(joint) + 1)
    q[:, columns] = np.rad2deg(q[:, columns])
    return changed(log, q=q)


def negative(x: FloatArray, *_: object) -> FloatArray:
    """Turn the sign."""
    return -x


def scaled(x: FloatArray, factor: float, _: np.random.Generator) -> FloatArray:
    """Scale."""
    return factor * x


def shifted(x: FloatArray, degrees: float, _: np.random.Generator) -> FloatArray:
    """Move the zero."""
    return x + np.deg2rad(degrees)


def only_noise(x: FloatArray, size: float, rng: np.random.Generator) -> FloatArray:
    """Forget the torque."""
    return size * np.std(x) * rng.standard_normal(len(x))


CORRUPTIONS = (
    Corruption("torque late, all joints [s]", ("torque-delay",), None, (0.005, 0.02, 0.05), torque(late, None)),
    Corruption("torque late, joint 2 [s]", ("torque-delay",), 1, (0.005, 0.02, 0.05), torque(late, 1)),
    Corruption("velocity late, joint 2 [s]", ("velocity-delay",), 1, (0.01, 0.05, 0.15), late_velocity),
    Corruption("torque sign, joint 1", ("torque-sign",), 0, (1.0,), torque(negative, 0)),
    Corruption("torque sign, joint 2", ("torque-sign",), 1, (1.0,), torque(negative, 1)),
    Corruption("torque sign, all", ("torque-sign",), None, (1.0,), torque(negative, None)),
    Corruption("angle sign, joint 1", ("angle-sign", "torque-sign"), 0, (1.0,), angle(negative, 0)),
    Corruption("angle sign, joint 2", ("angle-sign",), 1, (1.0,), angle(negative, 1)),
    Corruption("joints 1 and 2 swapped (torque, angle, both)", ("joint-order",), None, (0.0, 1.0, 2.0), swapped),
    Corruption("torque scale, all", ("torque-scale",), None, (1000.0, 0.12, 0.02), torque(scaled, None)),
    Corruption("torque scale, joint 2", ("torque-scale",), None, (1.1, 1.3, 50.0), torque(scaled, 1)),
    Corruption("degrees (all, joint 1, joint 2)", ("angle-scale",), None, (-1.0, 0.0, 1.0), in_degrees),
    Corruption("angle scale, joint 2", ("angle-scale",), 1, (1.02, 1.05, 1.2), angle(scaled, 1)),
    Corruption("angle zero, joint 2 [deg]", ("angle-offset",), 1, (2.0, 5.0, 15.0), angle(shifted, 1)),
    Corruption("base tilted [deg]", ("gravity-direction",), None, (1.0, 5.0, 15.0), tilted),
    Corruption("segment 1 longer", ("segment-length",), 0, (0.03, 0.05, 0.1), longer),
    Corruption("torque clipped, joint 2", ("saturation",), 1, (0.9, 0.75, 0.6), torque(clipped, 1)),
    Corruption("torque clipped on one side, joint 2", ("saturation",), 1, (0.9, 0.75, 0.6), torque(clipped_above, 1)),
    Corruption("torque frozen, joint 2 [s]", ("stuck-channel",), 1, (0.5, 2.0, 10.0), torque(frozen, 1)),
    Corruption("angle frozen, joint 2 [s]", ("stuck-channel",), 1, (1.0, 5.0, 17.0), angle(frozen, 1)),
    Corruption("samples missing [s]", ("missing-samples",), None, (0.02, 0.05, 0.1), gapped),
    Corruption("torque drops to zero, joint 2", ("dropout",), 1, (0.01, 0.02, 0.05), torque(dropped, 1)),
    Corruption("torque repeats values, joint 2", ("stale-samples",), 1, (2.0, 5.0, 10.0), torque(held, 1)),
    Corruption("one-sided spikes, joint 2", ("spikes",), 1, (0.005, 0.01, 0.03), torque(spiked, 1)),
    Corruption("strap [N/m]", ("unmodelled-force",), None, (50.0, 100.0, 200.0), strapped),
    Corruption("spring at joint 2", ("unmodelled-force",), 1, (0.2, 0.5, 1.0), spring),
    Corruption("cross-talk into joint 2", ("cross-talk",), 1, (0.02, 0.05, 0.1), mixed),
    Corruption("friction (Stribeck, square, load)", ("unmodelled-friction",), 1, (0.0, 1.0, 2.0), other_friction),
    Corruption("data twice", ("repeated-data",), None, (1.0, 0.5, 0.2), twice),
    Corruption("torque is noise, joint 2", ("large-residual",), 1, (1.0,), torque(only_noise, 1)),
)


def run(leg: str, which: int, size: float, seed: int) -> Outcome | None:
    """Corrupt a log, and say whether it matters and whether it is found; None where there is no such corruption."""
    corruption, rng = CORRUPTIONS[which], np.random.default_rng([seed, which])
    log = clean_log(leg, seed)
    try:
        bad = corruption.apply(log, size, rng)
    except ExoidError:
        return None
    findings = exoid.check(bad.leg, bad.recordings)
    joint = None if corruption.joint is None else log.leg.joint_names[corruption.joint]
    found = any(f.kind in corruption.kinds and joint in (None, f.joint) for f in findings)
    named = tuple(f"{f.kind}:{f.joint}" for f in findings if f.severity != "info")
    return Outcome(_moved(log, bad), found, named)


def _moved(log: Log, bad: Log) -> bool:
    """Whether a corruption moves a parameter out of its interval; data that occur twice only narrow intervals."""
    if len(bad.recordings) > len(log.recordings):
        return True
    before = exoid.identify(log.leg, log.recordings, check=False)
    try:
        after = exoid.identify(bad.leg, bad.recordings, check=False)
    except ExoidError:
        return True
    low, high = before.interval().T
    return bool(((after.values < low) | (after.values > high)).any())


def alarms(leg: str, seed: int) -> tuple[str, ...]:
    """Findings in a clean log."""
    log = clean_log(leg, 100_000 + seed)
    return tuple(f"{f.kind}:{f.joint}" for f in exoid.check(log.leg, log.recordings) if f.severity != "info")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=2, help="logs for each corruption, size and leg")
    parser.add_argument("--clean", type=int, default=20, help="logs without faults for each leg")
    parser.add_argument("--legs", default=",".join(LEGS))
    parser.add_argument("--only", default="", help="corruptions whose name contains this")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="say what was found instead")
    given = parser.parse_args(arguments)
    legs = given.legs.split(",")
    with ProcessPoolExecutor(given.workers) as pool:
        print(f"share found where it matters, of {given.seeds} logs for each leg ({', '.join(legs)}) and size")
        total = right = 0
        for which, corruption in enumerate(CORRUPTIONS):
            if given.only not in corruption.name:
                continue
            cells = []
            for size in corruption.sizes:
                jobs = [(leg, which, size, seed) for leg in legs for seed in range(given.seeds)]
                done = [one for one in pool.map(run, *zip(*jobs, strict=True)) if one is not None]
                matter = [one for one in done if one.moved]
                hits = sum(one.found for one in matter)
                total, right = total + len(matter), right + hits
                cells.append(f"{size:g}: {hits}/{len(matter)}")
                if given.verbose:
                    for job, one in zip(jobs, done, strict=False):
                        if one.moved and not one.found:
                            print("    missed", job[0], size, job[3], one.kinds)
            print(f"{corruption.name:46} {'   '.join(cells)}", flush=True)
        print(f"all corruptions: {right}/{total} ({right / max(total, 1):.1%})")
        for leg in legs if given.clean else ():
            found = list(pool.map(alarms, [leg] * given.clean, range(given.clean)))
            wrong = [one for one in found if one]
            print(f"false alarms, {leg}: {len(wrong)}/{len(found)}", *wrong[:10])


if __name__ == "__main__":
    main()
