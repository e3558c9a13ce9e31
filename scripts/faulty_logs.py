"""Logs that are simulated with and without faults.

A log is a motion of five harmonics with exact torques of Pinocchio, Coulomb and viscous friction, white and coloured
torque noise and quantised angles. Each fault is a function of a log, its size and a generator.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

import exoid
from exoid._typing import FloatArray
from exoid.errors import ExoidError

RATE, SECONDS = 100.0, 40.0
QUANTUM = 2.0 * np.pi / 2**16
"""Of the angles [rad]."""
SHARPNESS = 0.01
"""Width of the friction that is simulated [rad/s]; the model's is wider."""
COULOMB, VISCOUS = 0.06, 0.03
"""Friction over the RMS torque of the joint, at high speed and per rad/s."""
LEGS = ("bleex", "cuhk", "hyq")


class Log(NamedTuple):
    """Leg and recordings as they reach exoid, and the true parameters by name."""

    leg: exoid.Leg
    recordings: tuple[exoid.Recording, ...]
    truth: dict[str, float]


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


@lru_cache(maxsize=32)
def clean_log(name: str, seed: int, *, sharpness: float = SHARPNESS) -> Log:
    """Simulate a log without faults, with friction of some width [rad/s]."""
    leg, rng = leg_of(name), np.random.default_rng(seed)
    n = len(leg.joint_names)
    time = np.arange(int(SECONDS * RATE)) / RATE
    omega = 2.0 * np.pi * 0.1 * np.array([1.0, 2.0, 3.0, 5.0, 7.0])
    amplitude = 0.5 * rng.uniform(0.4, 1.0, (n, 5)) / np.array([1.0, 1.2, 1.5, 2.5, 3.5])
    phase = np.multiply.outer(time, omega)[:, None, :] + rng.uniform(0.0, 2.0 * np.pi, (n, 5))
    q, v = (amplitude * np.sin(phase)).sum(-1), (amplitude * omega * np.cos(phase)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(phase)).sum(-1)
    middle = np.array([0.3, -0.6, 0.1])[:n]
    tau = leg.inverse_dynamics(q + middle, v, a)
    size = np.sqrt(np.mean(tau**2, axis=0))
    tau = tau + COULOMB * size * np.tanh(v / sharpness) + VISCOUS * size * v
    white = rng.standard_normal(tau.shape)
    coloured = scipy.signal.lfilter([np.sqrt(1.0 - 0.82**2)], [1.0, -0.82], rng.standard_normal(tau.shape), axis=0)
    tau = tau + size * (0.01 * white + 0.005 * coloured)
    measured = QUANTUM * np.round((q + middle) / QUANTUM)
    log = exoid.Recording(time=time, q=measured, tau=tau, joint_names=leg.joint_names, largest_angle=np.inf)
    return Log(leg, (log,), _truth(leg, size))


def _truth(leg: exoid.Leg, size: FloatArray) -> dict[str, float]:
    """True parameters of a simulated log, by name; others are zero."""
    truth = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    for part, symbol in ((COULOMB, "c0"), (VISCOUS, "d")):
        truth |= {f"{symbol}_{label}": part * float(own) for label, own in zip(leg.joint_labels, size, strict=True)}
    return truth


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
    q = log.recordings[0].q
    turned = exoid.leg.dynamics.inverse_dynamics(model, q, 0.0 * q, 0.0 * q)
    return changed(log, tau=log.recordings[0].tau + turned - log.leg.gravity(q))


def longer(log: Log, part: float, _: np.random.Generator) -> Log:
    """Make the first segment of a planar leg longer in the model."""
    if log.leg.chain is None:
        raise ExoidError("not a planar leg")
    offsets = log.leg.chain.offsets.copy()
    offsets[0] *= 1.0 + part
    (limb,) = log.leg.limbs
    limb = replace(limb, chain=replace(limb.chain, offsets=offsets))
    return log._replace(leg=replace(log.leg, machine=replace(log.leg.machine, limbs=(limb,))))


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


def low_passed(x: FloatArray, seconds: float, _: np.random.Generator) -> FloatArray:
    """Pass a signal through the low-pass of its sensor, of first order."""
    pole = np.exp(-1.0 / (RATE * seconds))
    start = np.array([pole * x[0]])
    return scipy.signal.lfilter([1.0 - pole], [1.0, -pole], x, zi=start)[0]


def stale(x: FloatArray, share: float, rng: np.random.Generator) -> FloatArray:
    """Repeat the sample before, here and there."""
    return x[np.maximum.accumulate(np.where(at_random(share, x, rng), 0, np.arange(len(x))))]


def talking(log: Log, part: float, _: np.random.Generator) -> Log:
    """Let every sensor see a part of every other torque."""
    n = len(log.leg.joint_names)
    return changed(log, tau=log.recordings[0].tau @ (np.eye(n) + part * (1.0 - np.eye(n))))


def rubbing(form: Callable[[FloatArray, FloatArray], FloatArray]) -> Callable[..., Log]:
    """Add friction of another form to every joint, over the RMS torque."""

    def apply(log: Log, part: float, _: np.random.Generator) -> Log:
        one = log.recordings[0]
        v, size = np.gradient(one.q, axis=0) * RATE, np.std(one.tau, axis=0)
        return changed(log, tau=one.tau + part * size * form(v, one.tau / size))

    return apply


def direction(v: FloatArray) -> FloatArray:
    """Sign of the velocity, smooth."""
    return np.tanh(v / 0.02)


def noisier(form: Callable[[FloatArray, FloatArray], FloatArray]) -> Callable[..., Log]:
    """Add white noise whose size changes, over the RMS torque."""

    def apply(log: Log, part: float, rng: np.random.Generator) -> Log:
        one = log.recordings[0]
        v, size = np.gradient(one.q, axis=0) * RATE, np.std(one.tau, axis=0)
        return changed(log, tau=one.tau + part * size * form(v, one.tau / size) * rng.standard_normal(v.shape))

    return apply


def overlapping(log: Log, share: float, _: np.random.Generator) -> Log:
    """Pass two parts of a log that share the middle."""
    one = log.recordings[0]
    half, extra = len(one) // 2, int(0.5 * share * len(one))
    return log._replace(recordings=(one.slice(0, half + extra), one.slice(half - extra, len(one))))


def slow_clock(log: Log, part: float, _: np.random.Generator) -> Log:
    """Stamp samples with a clock that is slow."""
    return changed(log, time=log.recordings[0].time * (1.0 - part))


def geared(lag: Callable[[FloatArray, float], FloatArray]) -> Callable[..., Log]:
    """Let the link of joint 2 lag behind its encoder, which its friction is beside, by an angle of its load."""

    def apply(log: Log, size: float, _: np.random.Generator) -> Log:
        one = log.recordings[0]
        label = log.leg.joint_labels[1]
        v = np.gradient(one.q[:, 1]) * RATE
        friction = log.truth[f"c0_{label}"] * np.tanh(v / 0.02) + log.truth[f"d_{label}"] * v
        load = scipy.ndimage.gaussian_filter1d(one.tau[:, 1] - friction, 0.03 * RATE)  # without noise
        q = np.array(one.q)
        q[:, 1] += lag(load / np.std(load), size)
        return changed(log, q=QUANTUM * np.round(q / QUANTUM))

    return apply


def wrapped(log: Log, size: float, _: np.random.Generator) -> Log:
    """Wrap the angle of the second joint at some angle [rad]."""
    q = np.array(log.recordings[0].q)
    q[:, 1] = np.mod(q[:, 1] - size, 2.0 * np.pi) + size
    return changed(log, q=q)
