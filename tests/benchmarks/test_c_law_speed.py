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
from exoid.control import LAWS, Limited, MomentumObserver, default_gains, sensitivity_amplification, standard_laws
from exoid.control.in_c import write_c
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.online import RecursiveEstimator
from exoid.online.in_c import write_recursive

CALLS, ROUNDS = 20_000, 5
LONGEST = 3e-6
RATIO = 1.5
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
    names = [name for name in LAWS if name not in ("adaptive", "self_tuning")]  # they have no form in C
    laws = standard_laws(estimate, kp, kd, gait, 10.0, names=names)
    laws["sensitivity_amplification"] = sensitivity_amplification(estimate, 3.0)
    limited = {name: Limited(law, (150.0, 125.0, 90.0), 4000.0) for name, law in laws.items()}
    limited["momentum_observer"] = MomentumObserver(estimate, 8.0, 500.0, torque_delay=0.0)
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

void run(int count, const double *samples, int solve);
void clocked(int count, const double *samples, double *seconds);

void clocked(int count, const double *samples, double *seconds)
{
    static online_state state;
    struct timespec before, after;
    int k, complete;
    online_init(&state);
    for (k = 0; k < count; ++k) {
        clock_gettime(CLOCK_MONOTONIC, &before);
        complete = online_update(&state, samples + 6 * k, samples + 6 * k + 3);
        clock_gettime(CLOCK_MONOTONIC, &after);
        seconds[2 * k] = (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
        seconds[2 * k + 1] = 0.0;
        if (complete == 1) {
            clock_gettime(CLOCK_MONOTONIC, &before);
            online_solve(&state);
            clock_gettime(CLOCK_MONOTONIC, &after);
            seconds[2 * k + 1] =
                (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
        }
    }
}

void run(int count, const double *samples, int solve)
{
    static online_state state;
    int k;
    online_init(&state);
    for (k = 0; k < count; ++k) {
        if (online_update(&state, samples + 6 * (k % 3000), samples + 6 * (k % 3000) + 3) == 1 && solve) {
            online_solve(&state);
        }
    }
}
"""


@pytest.fixture(scope="module")
def recursive(estimate, tmp_path_factory):
    """A recursive estimator of 500 Hz: a function that takes CALLS samples and solves or not, and its longest times."""
    folder = tmp_path_factory.mktemp("recursive")
    online = RecursiveEstimator(estimate.leg, estimate.model.terms, forgetting="none", false_alarms=0.0)
    write_recursive(folder / "online.c", online)
    (folder / "run.c").write_text(RECURSIVE)
    flags = ("-std=gnu99", "-O2", "-shared", "-fPIC")  # GNU: its clock
    subprocess.run([COMPILER, *flags, folder / "run.c", "-o", folder / "run.so", "-lm"], check=True)
    library, log = ctypes.CDLL(str(folder / "run.so")), exoid.datasets.bleex_swing().train
    samples = np.ascontiguousarray(np.hstack([log.q, log.tau])[:3000])
    assert samples.shape == (3000, 6)
    at = samples.ctypes.data_as(ctypes.c_void_p)

    def longest():
        rounds = np.zeros((7, 3000, 2))
        for one in rounds:
            library.clocked(3000, at, one.ctypes.data_as(ctypes.c_void_p))
        return rounds.min(axis=0).max(axis=0)  # the shortest of each sample, so that interruptions do not count

    return lambda solve: library.run(CALLS, at, solve), longest


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


def test_a_sample_of_the_recursive_estimator_takes_three_microseconds_on_average(estimate, recursive):
    run, longest = recursive
    works = {
        BARE: rnea_of(estimate),
        "a sample in C": lambda: run(0),
        "a sample in C, solved after each block": lambda: run(1),
    }
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} samples of a recursive estimator at 500 Hz", best, BARE)
    seconds = best["a sample in C, solved after each block"]
    print(f"{1e6 * seconds / CALLS:.2f} us a sample, {seconds / best[BARE]:.2f} of one pin.rnea")
    update, solve = longest()
    print(f"longest: update {1e6 * update:.2f} us, solve {1e6 * solve:.2f} us")
    assert seconds <= LONGEST * CALLS


def test_a_step_takes_three_microseconds_at_most(estimate, steps):
    works = {BARE: rnea_of(estimate), **{f"{name}, a step in C": step for name, step in steps.items()}}
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} steps of a law", best, BARE)
    slowest = max(seconds for name, seconds in best.items() if name.endswith("in C"))
    print(f"slowest law: {1e6 * slowest / CALLS:.2f} us a step, {slowest / best[BARE]:.2f} of one pin.rnea")
    assert slowest <= RATIO * best[BARE]
    assert slowest <= LONGEST * CALLS
