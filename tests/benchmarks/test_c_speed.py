"""What a leg's torques cost in C, against one call of Pinocchio's RNEA from Python.

``pytest tests/benchmarks/test_c_speed.py -s`` prints the times.
"""

import ctypes
import shutil
import subprocess

import numpy as np
import pinocchio as pin
import pytest
from closed_machines import four_bar_knee
from planar_chains import assert_relative, random_motion
from turns import best_of_turns, show

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.codegen import c_source
from exoid.torques import TorqueModel

CALLS, ROUNDS = 20_000, 5
RATIO = 1.0
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
    flags = ("-std=c99", "-O2", "-shared", "-fPIC")
    subprocess.run([COMPILER, *flags, folder / "harness.c", "-o", folder / "leg.so", "-lm"], check=True)
    library = ctypes.CDLL(str(folder / "leg.so"))

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


def test_the_loop_in_c_computes_the_torque_of_the_estimate(estimate, compiled, motion):
    assert_relative(compiled("all_of_it", motion), estimate.torque(*motion), 1e-12)


def test_a_call_in_c_costs_less_than_one_bare_rnea_from_python(estimate, compiled, motion):
    model, data = estimate.leg.model, estimate.leg.model.createData()
    rows = list(zip(*motion, strict=True))

    def bare():
        for q, v, a in rows:
            pin.rnea(model, data, q, v, a)

    works = {
        BARE: bare,
        "inverse dynamics with every term, in C": lambda: compiled("all_of_it", motion),
        "gravity and friction, in C": lambda: compiled("gravity_and_friction", motion),
    }
    best = best_of_turns(works, ROUNDS)
    show(f"{CALLS:,} calls of a leg's torques", best, BARE)
    assert max(seconds for name, seconds in best.items() if name.endswith("in C")) <= RATIO * best[BARE]


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
    best = best_of_turns(works, ROUNDS)
    show("200 calls of a closed leg's torques", best, next(iter(works)))
    assert best["four-bar knee, in C"] < 0.1 * max(best.values())
