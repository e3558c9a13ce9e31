"""Reference motions of the proving ground: four kinds, none of them by exoid's planner."""

from __future__ import annotations

import itertools

import numpy as np

from .friction import STEP, Array


def harmonics(rng: np.random.Generator, t: Array) -> Array:
    """Eight harmonics of a slow fundamental."""
    k = np.arange(1, 9)
    phase = rng.uniform(0.0, 2.0 * np.pi, 8) + np.multiply.outer(t, 2.0 * np.pi * 0.1 * k)
    return np.sin(phase) @ (rng.uniform(0.2, 1.0, 8) / k)


def sweep(rng: np.random.Generator, t: Array) -> Array:
    """Sine that becomes faster, about a slow one."""
    fast = rng.uniform(0.4, 1.0)
    phase = 2.0 * np.pi * (0.05 * t + 0.5 * fast * t**2 / t[-1]) + rng.uniform(0.0, 6.0)
    return np.sin(phase) + 0.8 * np.sin(2.0 * np.pi * rng.uniform(0.05, 0.12) * t + rng.uniform(0.0, 6.0))


def stops(rng: np.random.Generator, t: Array) -> Array:
    """Point to point with rests, each path of minimum jerk."""
    out, time, place = np.zeros(len(t)), 0.0, rng.uniform(-1.0, 1.0)
    while time < t[-1]:
        goal, takes, rests = rng.uniform(-1.0, 1.0), rng.uniform(0.8, 2.5), rng.uniform(0.1, 0.5)
        s = np.clip((t - time) / takes, 0.0, 1.0)
        now = (t >= time) & (t <= time + takes + rests)
        out[now] = place + (goal - place) * (s**3 * (10.0 - 15.0 * s + 6.0 * s**2))[now]
        place, time = goal, time + takes + rests
    return out


def gait(rng: np.random.Generator, t: Array) -> Array:
    """Strides of slowly changing size."""
    omega = 2.0 * np.pi * rng.uniform(0.4, 0.8)
    stride = sum(rng.uniform(0.2, 1.0) / k * np.sin(k * omega * t + rng.uniform(0.0, 6.0)) for k in (1, 2, 3))
    return stride * (1.0 + 0.4 * np.sin(2.0 * np.pi * 0.07 * t + rng.uniform(0.0, 6.0)))


KINDS = {"harmonics": harmonics, "sweep": sweep, "stops": stops, "gait": gait}


def reference(kind: str, count: int, seconds: float, seed: int) -> tuple[Array, Array, Array]:
    """Angles, velocities and accelerations within drawn limits of angle and speed, (N, n) each."""
    rng = np.random.default_rng([seed, *kind.encode()])
    t = np.arange(round(seconds / STEP) + 1) * STEP
    q = np.column_stack([KINDS[kind](rng, t) for _ in range(count)])
    q -= 0.5 * (q.max(axis=0) + q.min(axis=0))
    v = np.gradient(q, STEP, axis=0)
    speed, reach = rng.uniform(0.8, 2.5, count), rng.uniform(0.3, 1.2, count)
    scale = np.minimum(reach / np.abs(q).max(axis=0), speed / np.abs(v).max(axis=0))
    q = rng.uniform(-0.6, 0.6, count) + scale * q
    v = scale * v
    return q, v, np.gradient(v, STEP, axis=0)


def pairs() -> list[tuple[str, str]]:
    """Kinds of motion to learn from and to be judged on: never the same, and strides alone teach nothing."""
    return [(a, b) for a, b in itertools.permutations(KINDS, 2) if a != "gait"]
