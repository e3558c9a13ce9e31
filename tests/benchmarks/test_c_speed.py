"""What a leg's torques, and one step of a law or an observer, cost in C, against one call of Pinocchio's RNEA.

``pytest tests/benchmarks/test_c_speed.py -s`` prints the times.
"""

import ctypes
import shutil
import subprocess

import numpy as np
import pinocchio as pin
import pytest
from closed_machines import four_bar_knee
from planar_chains import random_motion
from turns import best_of_turns, show

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.codegen import c_source, write_c
from exoid.control import LAWS, Limited, MomentumObserver, default_gains, sensitivity_amplification, standard_laws
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.torques import TorqueModel

CALLS, ROUNDS = 20_000, 3
TORQUE, STEP = 1.0, 1.5
"""Largest ratios to one call of RNEA."""

BARE = "pin.rnea from Python"

COMPILER = shutil.which("cc")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc)")

HARNESS = """
#include "leg.c"

void all_of_it(int count, const leg_real *q, const leg_real *v, const leg_real *a, leg_real *tau)
{
    int k;
    for (k = 0; k < count; ++k) {
        int at = k * LEG_JOINTS;
        leg_inverse_dynamics(q + at, v + at, a + at, tau + at);
    }
}

void gravity_and_friction(int count, const leg_real *q, const leg_real *v, const leg_real *a, leg_real *tau)
{
    leg_real friction[LEG_JOINTS];
    int j, k;
    (void)a;
    for (k = 0; k < count; ++k) {
        int at = k * LEG_JOINTS;
        leg_gravity(q + at, tau + at);
        leg_friction(v + at, friction);
        for (j = 0; j < LEG_JOINTS; ++j) {
            tau[at + j] += friction[j];
        }
    }
}
"""


OF_A_LAW = """
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
    return OF_A_LAW.format(name=source.prefix, target=target)


def shared_library(source, to):
    """A C file as a library."""
    subprocess.run([COMPILER, "-std=c99", "-O2", "-shared", "-fPIC", source, "-o", to, "-lm"], check=True)
    return ctypes.CDLL(str(to))


@pytest.fixture(scope="module")
def estimate():
    """BLEEX with every term, from data."""
    data = exoid.datasets.bleex_swing()
    terms = (Coulomb(), Viscous(), Armature(), Stiffness(joints=("knee", "ankle")), Offset(joints=("hip",)))
    return exoid.identify(data.leg, data.train, terms=terms)


@pytest.fixture(scope="module")
def motion():
    return random_motion(np.random.default_rng(0), 3, CALLS, turns=0.5)


def compile_loops(folder, source):
    """The C of a leg, called in loops that are C too."""
    (folder / "leg.c").write_text(source)
    (folder / "harness.c").write_text(HARNESS)
    library = shared_library(folder / "harness.c", folder / "leg.so")

    def run(function, motion):
        tau = np.empty_like(motion[0])
        arrays = (np.ascontiguousarray(x).ctypes.data_as(ctypes.c_void_p) for x in (*motion, tau))
        getattr(library, function)(ctypes.c_int(len(tau)), *arrays)
        return tau

    return run


@pytest.fixture(scope="module")
def compiled(estimate, tmp_path_factory):
    """The C of BLEEX."""
    folder = tmp_path_factory.mktemp("leg")
    return compile_loops(folder, estimate.to_c(folder / "leg.c").text)


@pytest.fixture(scope="module")
def bare(estimate, motion):
    """CALLS calls of Pinocchio's RNEA."""
    model, data = estimate.leg.model, estimate.leg.model.createData()
    rows = list(zip(*motion, strict=True))

    def calls():
        for q, v, a in rows:
            pin.rnea(model, data, q, v, a)

    return calls


def test_a_call_in_c_costs_less_than_one_bare_rnea_from_python(bare, compiled, motion):
    works = {
        BARE: bare,
        "inverse dynamics with every term, in C": lambda: compiled("all_of_it", motion),
        "gravity and friction, in C": lambda: compiled("gravity_and_friction", motion),
    }
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} calls of a leg's torques", best, BARE)
    assert max(seconds for name, seconds in best.items() if name.endswith("in C")) <= TORQUE * best[BARE]


def test_a_four_bar_knee_in_c_costs_less_than_closing_its_loop_in_python(tmp_path):
    """A call of Python's closes one pose; so does each call in C."""
    leg = four_bar_knee(0).leg(tmp_path)
    in_c = compile_loops(tmp_path, c_source(TorqueModel(leg, ()), leg.parameters).text)
    motion = tuple(random_motion(np.random.default_rng(0), 2, 200, turns=0.05))
    works = {
        "four-bar knee, one pose at a time, in Python": lambda: [
            leg.inverse_dynamics(*x) for x in zip(*motion, strict=True)
        ],
        "four-bar knee, in C": lambda: in_c("all_of_it", motion),
    }
    best = best_of_turns(works, 2)
    show("200 calls of a closed leg's torques", best, next(iter(works)))
    assert best["four-bar knee, in C"] < 0.01 * max(best.values())


@pytest.fixture(scope="module")
def steps(tmp_path_factory):
    """Each law as a function that takes CALLS steps in C."""
    folder, data = tmp_path_factory.mktemp("laws"), exoid.datasets.bleex_swing()
    estimate = exoid.identify(data.leg, data.train)
    gait = gait_for_leg(estimate.leg, healthy_gait(0.8, 10.0))
    kp, kd = default_gains(estimate, np.zeros(3))
    found = {}
    names = [name for name in LAWS if name != "self_tuning"]  # which have no form in C
    laws = standard_laws(estimate, kp, kd, gait, 10.0, names=names)
    laws["sensitivity_amplification"] = sensitivity_amplification(estimate, 3.0)
    limited = {name: Limited(law, (150.0, 125.0, 90.0), 4000.0) for name, law in laws.items()}
    limited["momentum_observer"] = MomentumObserver(estimate, 8.0, 500.0, torque_delay=0.0)
    for name, law in limited.items():
        source = write_c(folder / f"{name}.c", law)
        (folder / f"run_{name}.c").write_text(harness(source))
        # a slow motion: jumps start an observer again. More numbers than any law has; counters are written over them
        inputs = 0.3 * np.sin(2.0 * np.pi * np.arange(5120.0) / 5120.0)
        found[name] = _runner(shared_library(folder / f"run_{name}.c", folder / f"{name}.so"), inputs)
    return found


def _runner(library, inputs):
    tau = np.zeros(3)
    return lambda: library.run(CALLS, inputs.ctypes.data_as(ctypes.c_void_p), tau.ctypes.data_as(ctypes.c_void_p))


def test_a_step_costs_at_most_half_more_than_one_call_of_rnea(bare, steps):
    works = {BARE: bare, **{f"{name}, a step in C": step for name, step in steps.items()}}
    best = best_of_turns(works, 3)
    show(f"{CALLS:,} steps of a law", best, BARE)
    slowest = max(seconds for name, seconds in best.items() if name.endswith("in C"))
    print(f"slowest law: {1e6 * slowest / CALLS:.2f} us a step, {slowest / best[BARE]:.2f} of one pin.rnea")
    assert slowest <= STEP * best[BARE]
