"""What one step of a law, an observer, or a recursive estimator costs in C, against one call of Pinocchio's RNEA.

``pytest tests/benchmarks/test_c_law_speed.py -s`` prints the times.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pinocchio as pin
import pytest
from turns import best_of_turns, show

import exoid
from exoid.control import (
    LAWS,
    KalmanObserver,
    Limited,
    MomentumObserver,
    default_gains,
    sensitivity_amplification,
    standard_laws,
)
from exoid.control.in_c import write_c
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.online import RecursiveEstimator
from exoid.online.in_c import write_recursive

CALLS, ROUNDS = 20_000, 5
LONGEST = 3e-6
RATIO = 1.5
LEARNS, LEARNING = "adaptive", 200e-6
"""Adaptive control, which projects its parameters with each step, and its longest step."""

BARE = "pin.rnea from Python"

COMPILER = shutil.which("cc")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc)")

HARNESS = """
#include "{name}.c"

void run(int count, {name}_input *in, {name}_real *tau)
{{
    {name}_state state;
    int k;
    {name}_init(&state);
    for (k = 0; k < count; ++k) {{
        in[k % 256].reading = (uint32_t)k + 1;
        {target}
        {name}_step(&state, in + k % 256, tau);
    }}
}}
"""


def harness(source):
    """A loop around the law, with counters that never stand still."""
    has_target = any(each.source == "target" for each in source.law.inputs)
    target = "in[k % 256].target = (uint32_t)k + 1;" if has_target else ""
    return HARNESS.format(name=source.prefix, target=target)


@pytest.fixture(scope="module")
def estimate():
    data = exoid.datasets.bleex_swing()
    return exoid.identify(data.leg, data.train)


@pytest.fixture(scope="module")
def steps(estimate, tmp_path_factory):
    """Each law as a function that takes CALLS steps in C."""
    folder = tmp_path_factory.mktemp("laws")
    gait = gait_for_leg(estimate.leg, healthy_gait(0.8, 10.0))
    kp, kd = default_gains(estimate, np.zeros(3))
    rng, found = np.random.default_rng(0), {}
    names = [name for name in LAWS if name != "self_tuning"]  # which has no form in C
    laws = standard_laws(estimate, kp, kd, gait, 10.0, names=names)
    laws["sensitivity_amplification"] = sensitivity_amplification(estimate, 3.0)
    limited = {name: Limited(law, (150.0, 125.0, 90.0), 4000.0) for name, law in laws.items()}
    limited["momentum_observer"] = MomentumObserver(estimate, 8.0, 500.0, torque_delay=0.0)
    limited["kalman_observer"] = KalmanObserver(estimate, 8.0, 500.0, torque_delay=0.0)
    for name, law in limited.items():
        source = write_c(folder / f"{name}.c", law)
        (folder / f"run_{name}.c").write_text(harness(source))
        flags = ("-std=c99", "-O2", "-shared", "-fPIC")
        subprocess.run([COMPILER, *flags, folder / f"run_{name}.c", "-o", folder / f"{name}.so", "-lm"], check=True)
        inputs = rng.uniform(-1.0, 1.0, (256, 20))  # more numbers than any law has; its counters are written over them
        found[name] = _runner(ctypes.CDLL(str(folder / f"{name}.so")), inputs)
    return found


RECURSIVE = """
#include <time.h>
#include "online.c"

void run(int count, const double *samples, int length);
int clocked(int count, const double *samples, double *seconds);

int clocked(int count, const double *samples, double *seconds)
{
    static online_state state;
    struct timespec before, after;
    int k;
    online_init(&state);
    for (k = 0; k < count; ++k) {
        clock_gettime(CLOCK_MONOTONIC, &before);
        online_update(&state, samples + 6 * k, samples + 6 * k + 3);
        clock_gettime(CLOCK_MONOTONIC, &after);
        seconds[k] = (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
    }
    return %s;
}

void run(int count, const double *samples, int length)
{
    static online_state state;
    int k;
    online_init(&state);
    for (k = 0; k < count; ++k) {
        online_update(&state, samples + 6 * (k %% length), samples + 6 * (k %% length) + 3);
    }
}
"""

CHANGED = 12_500
"""Samples before the change."""

WITHOUT, WITH = "without forgetting", "forgetting and change detection"
RECURSIVE_SETTINGS = {WITHOUT: {"forgetting": "none", "false_alarms": 0.0}, WITH: {}}


@pytest.fixture(scope="module")
def walk(estimate):
    """Thirty seconds of motion at 500 Hz, in which friction at the knee doubles after 25 s: angles and torques."""
    model, n = estimate.model, 15_000
    time, phase = np.arange(n)[:, None] / 500.0, np.array([0.0, 1.0, 2.0])
    q, v, a = np.zeros((3, n, 3))
    for size, frequency in ((np.array([0.4, 0.5, 0.3]), 0.6), (np.array([0.15, 0.2, 0.1]), 1.37)):
        w = 2.0 * np.pi * frequency * np.array([1.0, 1.3, 1.7])
        q += size * np.sin(w * time + phase)
        v += size * w * np.cos(w * time + phase)
        a -= size * w**2 * np.sin(w * time + phase)
    changed = estimate.values * np.where([name in ("c0_knee", "d_knee") for name in estimate.names], 3.0, 1.0)
    noise = 0.3 * np.random.default_rng(0).standard_normal((n, 3))
    parts = (slice(None, CHANGED), estimate.values), (slice(CHANGED, None), changed)
    tau = np.concatenate([model.regressor(q[k], v[k], a[k]) @ beta for k, beta in parts]) + noise
    return np.ascontiguousarray(np.hstack([q, tau]))


@pytest.fixture(scope="module")
def recursive(estimate, walk, tmp_path_factory):
    """Recursive estimators of 500 Hz: what takes CALLS samples, and what tells their longest time and the changes."""
    found = {}
    for name, settings in RECURSIVE_SETTINGS.items():
        folder = tmp_path_factory.mktemp("recursive")
        write_recursive(folder / "online.c", RecursiveEstimator(estimate.leg, estimate.model.terms, **settings))
        (folder / "run.c").write_text(RECURSIVE % ("0" if name == WITHOUT else "state.changes"))
        flags = ("-std=gnu99", "-O2", "-shared", "-fPIC")  # GNU: its clock
        subprocess.run([COMPILER, *flags, folder / "run.c", "-o", folder / "run.so", "-lm"], check=True)
        found[name] = _timed(ctypes.CDLL(str(folder / "run.so")), walk.ctypes.data_as(ctypes.c_void_p), len(walk))
    return found


def _timed(library, at, length):
    def longest():
        rounds = np.zeros((7, length))
        changes = [library.clocked(length, at, one.ctypes.data_as(ctypes.c_void_p)) for one in rounds]
        return rounds.min(axis=0), changes[0]  # the shortest of each sample, so that interruptions do not count

    return lambda: library.run(CALLS, at, length), longest


def _runner(library, inputs):
    tau = np.zeros(3)
    return lambda: library.run(CALLS, inputs.ctypes.data_as(ctypes.c_void_p), tau.ctypes.data_as(ctypes.c_void_p))


def rnea_of(estimate):
    """CALLS calls of Pinocchio's RNEA."""
    model, data = estimate.leg.model, estimate.leg.model.createData()
    q, v, a = np.random.default_rng(1).uniform(-1.0, 1.0, (3, CALLS, 3))
    rows = list(zip(q, v, a, strict=True))

    def bare():
        for row in rows:
            pin.rnea(model, data, *row)

    return bare


def test_no_sample_of_the_recursive_estimator_takes_longer_than_three_microseconds_before_a_change(estimate, recursive):
    works = {BARE: rnea_of(estimate), **{f"{name}, a sample in C": run for name, (run, _) in recursive.items()}}
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} samples of a recursive estimator at 500 Hz", best, BARE)
    rnea = best[BARE] / CALLS
    for name, (_, longest) in recursive.items():
        seconds, changes = longest()
        before, after = seconds[:CHANGED].max(), seconds[CHANGED:].max()
        print(
            f"{name}: mean {1e6 * seconds.mean():.2f} us ({seconds.mean() / rnea:.2f} of one pin.rnea), longest "
            f"{1e6 * before:.2f} us ({before / rnea:.2f}) of {CHANGED:,} samples, {1e6 * after:.2f} us "
            f"({after / rnea:.2f}) around and after {changes} changes"
        )
        assert changes == (name == WITH)
        assert before <= LONGEST
        assert after <= LONGEST * (1.0 + (name == WITH))  # what was known before the change has its own R factor


def test_a_step_takes_three_microseconds_at_most(estimate, steps):
    works = {BARE: rnea_of(estimate), **{f"{name}, a step in C": step for name, step in steps.items()}}
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} steps of a law", best, BARE)
    slowest = max(seconds for name, seconds in best.items() if name.endswith("in C") and not name.startswith(LEARNS))
    learns = best[f"{LEARNS}, a step in C"]
    print(f"{LEARNS}: {1e6 * learns / CALLS:.2f} us a step, {learns / best[BARE]:.2f} of one pin.rnea")
    print(f"slowest law: {1e6 * slowest / CALLS:.2f} us a step, {slowest / best[BARE]:.2f} of one pin.rnea")
    assert learns <= LEARNING * CALLS
    assert slowest <= RATIO * best[BARE]
    assert slowest <= LONGEST * CALLS
