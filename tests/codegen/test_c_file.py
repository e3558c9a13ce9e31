"""The C file: strict C99, no state, tells where it comes from, and is refused where it would be wrong."""

import shutil
import subprocess

import numpy as np
import pytest
from compiled import COMPILER, CompiledLeg, compile_c, made_up, needs_compiler, source_of
from planar_chains import assert_relative, random_motion
from processes import run

import exoid
from exoid import Leg
from exoid.estimate.data import Input
from exoid.leg.description import describe

CUHK = exoid.load_leg("cuhk")
ESTIMATE = made_up(CUHK)


def checked(tmp_path, *flags):
    """Compile a file by flags that not every compiler has; skip where it does not."""
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    command = [str(COMPILER), *flags, str(tmp_path / "empty.c"), "-o", str(tmp_path / "empty")]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip(f"the compiler does not know {' '.join(flags)}")
    return flags


@needs_compiler
@pytest.mark.skipif(shutil.which("nm") is None, reason="needs nm")
@pytest.mark.parametrize(("precision", "suffix"), [("double", ""), ("float", "f")])
def test_it_keeps_no_state_and_needs_the_mathematical_library_only(precision, suffix, tmp_path):
    ESTIMATE.to_c(tmp_path / "leg.c", precision=precision)
    compile_c(("-O2", "-c"), tmp_path / "leg.c", to=tmp_path / "leg.o")
    symbols = [line.split()[-2:] for line in run("nm", tmp_path / "leg.o").splitlines()]
    wanted = {f"{name}{suffix}" for name in ("sin", "cos", "sincos", "tanh", "fabs", "exp")} | {"_GLOBAL_OFFSET_TABLE_"}
    assert {name for kind, name in symbols if kind == "U"} <= wanted
    assert not {name for kind, name in symbols if kind.upper() in "BDCS"}, "writable data"
    assert {name for kind, name in symbols if kind == "T"} == set(source_of(ESTIMATE, "leg").functions)


@needs_compiler
@pytest.mark.parametrize("precision", ["double", "float"])
def test_sanitizers_find_nothing(precision, tmp_path):
    """A program of its own, as Python itself was not built for them."""
    flags = checked(tmp_path, "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    ESTIMATE.to_c(tmp_path / "leg.c", precision=precision)
    (tmp_path / "main.c").write_text(MAIN)
    compile_c(("-g", *flags), tmp_path / "leg.c", tmp_path / "main.c", to=tmp_path / "main")
    done = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


MAIN = """
#include <stdio.h>
#define LEG_DECLARATIONS_ONLY
#include "leg.c"

int main(void)
{
    leg_real q[LEG_JOINTS] = {0}, v[LEG_JOINTS] = {0}, a[LEG_JOINTS] = {0}, tau[LEG_JOINTS];
    leg_real M[LEG_JOINTS][LEG_JOINTS];
    int k;
    for (k = -100; k < 100; ++k) {
        q[0] = v[1] = a[LEG_JOINTS - 1] = (leg_real)k;
        leg_gravity(q, tau);
        leg_friction(v, tau);
        leg_stiffness(q, tau);
        leg_mass_matrix(q, M);
        leg_rigid_bodies(q, v, a, tau);
        leg_inverse_dynamics(q, v, a, tau);
    }
    return printf("%g\\n", (double)tau[0]) < 0;
}
"""


@needs_compiler
def test_it_compiles_as_cpp_too(tmp_path):
    ESTIMATE.to_c(tmp_path / "leg.c")
    command = [str(shutil.which("c++") or pytest.skip("no C++ compiler")), "-x", "c++", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([*command, "-c", str(tmp_path / "leg.c"), "-o", str(tmp_path / "leg.o")], check=True)


@needs_compiler
def test_no_name_can_break_out_of_a_comment(tmp_path):
    nasty = '*/ #error "out" /*??/\\\n é \x07*\x00/'
    joints = ("hip*/ int x; /*", "knee??/")
    text = CUHK.description.text.replace("left_hip", joints[0]).replace("left_knee", joints[1])
    leg = Leg.from_description(describe(text, name=nasty), joints, cumulative=False)
    estimate = made_up(leg, inputs=(Input(nasty, nasty, 3, 1.0),), warnings=(nasty,))
    c = CompiledLeg(source_of(estimate), tmp_path)
    motion = random_motion(np.random.default_rng(0), 2)
    assert_relative(c("inverse_dynamics", *motion), estimate.torque(*motion), 1e-12)
    assert (tmp_path / "leg.c").read_bytes().isascii()
