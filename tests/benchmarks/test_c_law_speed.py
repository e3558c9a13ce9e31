"""What one step of a law or an observer costs in C, against one call of Pinocchio's RNEA.

``pytest tests/benchmarks/test_c_law_speed.py -s`` prints the times.
"""

import ctypes
import shutil
import subprocess

import numpy as np
import pinocchio as pin
import pytest
from turns import best_of_turns, show

import exoid
from exoid.codegen import write_c
from exoid.control import (
    LAWS,
    Limited,
    MomentumObserver,
    default_gains,
    sensitivity_amplification,
    standard_laws,
)
from exoid.experiments import gait_for_leg, healthy_gait

CALLS, ROUNDS = 20_000, 3
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
    has_target = any(each.source == "target" for each in source.content.inputs)
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
    names = [name for name in LAWS if name != "self_tuning"]  # which have no form in C
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


def test_a_step_costs_at_most_half_more_than_one_call_of_rnea(estimate, steps):
    works = {BARE: rnea_of(estimate), **{f"{name}, a step in C": step for name, step in steps.items()}}
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} steps of a law", best, BARE)
    slowest = max(seconds for name, seconds in best.items() if name.endswith("in C"))
    print(f"slowest law: {1e6 * slowest / CALLS:.2f} us a step, {slowest / best[BARE]:.2f} of one pin.rnea")
    assert slowest <= RATIO * best[BARE]
