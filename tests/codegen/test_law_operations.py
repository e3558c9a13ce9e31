"""Operations counted in the text of a law are those that it does when it runs."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest
from compiled_laws import record_type, records
from laws_of_bleex import laws, random_values

from exoid import ExoidError
from exoid.codegen.laws import Operations, Safety, count_operations
from exoid.control.in_c import c_source

GXX = shutil.which("g++")

COUNTED = ("pd_gravity_friction", "computed_torque", "sensitivity_amplification", "lqr")

KINDS = ("+ −", "×", "÷", "compare", "cos", "exp", "fmod", "rint", "sin", "tanh")

COUNTING = """
#include <math.h>
#include <stdint.h>
static long counted[%d];
struct real {
    double x;
    real() {}
    real(double value) : x(value) {}
    explicit operator int() const { return (int)x; }
};
static real one(int kind, double x) { ++counted[kind]; return real(x); }
static real operator-(real a) { return one(0, -a.x); }
static real operator+(real a, real b) { return one(0, a.x + b.x); }
static real operator-(real a, real b) { return one(0, a.x - b.x); }
static real operator*(real a, real b) { return one(1, a.x * b.x); }
static real operator/(real a, real b) { return one(2, a.x / b.x); }
static real &operator+=(real &a, real b) { return a = a + b; }
static real &operator-=(real &a, real b) { return a = a - b; }
static real &operator*=(real &a, real b) { return a = a * b; }
static bool operator<(real a, real b) { ++counted[3]; return a.x < b.x; }
static bool operator>(real a, real b) { ++counted[3]; return a.x > b.x; }
static bool operator<=(real a, real b) { ++counted[3]; return a.x <= b.x; }
static real fabs(real a) { return one(3, fabs(a.x)); }
static real cos(real a) { return one(4, cos(a.x)); }
static real exp(real a) { return one(5, exp(a.x)); }
static real fmod(real a, real b) { return one(6, fmod(a.x, b.x)); }
static real rint(real a) { return one(7, rint(a.x)); }
static real sin(real a) { return one(8, sin(a.x)); }
static real tanh(real a) { return one(9, tanh(a.x)); }
"""


@pytest.fixture(scope="module")
def counting(tmp_path_factory):
    """Laws whose numbers count what is done with them: the C as C++ with a class for its type of number."""
    if GXX is None:
        pytest.skip("needs g++")
    folder = tmp_path_factory.mktemp("counting")
    text, sources = COUNTING % len(KINDS), {}
    for name, law in ((name, laws()[name]) for name in COUNTED):
        source = sources[name] = c_source(law, name=name, safety=Safety("gravity" if name == "lqr" else "damping"))
        (folder / source.header_name).write_text(
            source.header.replace(f"typedef double {name}_real", f"typedef real {name}_real")
        )
        text += f"""
{source.source}
static {name}_state state_{name};
extern "C" void {name}_count(int n, const {name}_input *in, long *found)
{{
    {name}_init(&state_{name});
    for (int k = 0; k < n; ++k) {{
        {name}_real tau[{name.upper()}_JOINTS];
        for (int i = 0; i < {len(KINDS)}; ++i) counted[i] = 0;
        {name}_step(&state_{name}, in + k, tau);
        for (int i = 0; i < {len(KINDS)}; ++i) found[k * {len(KINDS)} + i] = counted[i];
    }}
}}
"""
    (folder / "counting.cpp").write_text(text)
    command = [GXX, "-O0", "-w", "-shared", "-fPIC", str(folder / "counting.cpp"), "-o", str(folder / "counting.so")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(folder / "counting.so")), sources


@pytest.mark.parametrize("name", COUNTED)
def test_no_step_does_more_than_was_counted_and_a_normal_one_hardly_less(counting, name):
    library, sources = counting
    values = random_values(250)
    rows = records(sources[name], 250, values)
    rows["v"][200::9, 1] = np.nan
    rows["reading"][230:240] = rows["reading"][230]
    found = np.zeros((250, len(KINDS)), ctypes.c_long)
    assert record_type(sources[name]).itemsize == rows.itemsize
    getattr(library, f"{name}_count")(250, rows.ctypes.data_as(ctypes.c_void_p), found.ctypes.data_as(ctypes.c_void_p))
    counted = sources[name].operations.by_kind
    limits = np.array([counted.get(kind, 0) for kind in KINDS])
    assert (found <= limits).all()
    assert set(counted) <= set(KINDS)
    normal = dict(zip(KINDS, found[1:200].max(axis=0).tolist(), strict=True))  # the first step also begins
    inner = count_operations(sources[name].source, sources[name].header, f"{name}_law").by_kind
    if name == "computed_torque":
        inner["×"] -= 3  # constant times sharp sign, which are plain numbers in C++ and not counted
    for kind in KINDS:
        if kind not in ("+ −", "compare"):  # those are in the limits too
            assert normal[kind] == inner.get(kind, 0)
    assert inner["+ −"] + 6 <= normal["+ −"] <= inner["+ −"] + 12


C = """
#define N 3
static const double k_table[N] = {1.0, 2.0, 3.0};
static double square(double x) { return x * x; }
void f(const double *x, double *y)
{
    int i, j;
    double sum = 0.0;
    for (i = 0; i < N; ++i) {
        for (j = i; j < N; ++j) {
            sum += (i + 1 < N ? square(x[i]) / k_table[j] : x[i + j * N]);
        }
        if (x[i] > 0.0 && i > 0) {
            sum = sinf(sum);
        } else {
            sum = -sum - 1.0;
        }
    }
    *y = fabs(sum) < 1.0 ? sqrt(sum) : (double)i;
}
"""


def test_loops_branches_and_calls_are_counted_by_hand():
    """Six additions in the loops; five squares and quotients, as the last i has none; each branch at its worst."""
    counted = count_operations(C, "#define N 3\n", "f")
    assert counted.by_kind == {"+ −": 6 + 6, "×": 5, "÷": 5, "compare": 3 + 2, "sin": 3, "sqrt": 1}
    assert str(counted) == "12 + −, 5 ×, 5 ÷, 5 compare, 3 sin, 1 sqrt"


def test_a_loop_of_unknown_length_is_refused():
    with pytest.raises(ExoidError, match="length is not known"):
        count_operations("void f(int n, double *x) { int i; for (i = 0; i < n; ++i) { x[i] = 0.0; } }", "", "f")


def test_syntax_that_is_not_known_is_refused():
    with pytest.raises(ExoidError, match="cannot be counted"):
        count_operations("void f(double *x) { while (x[0] > 0.0) { x[0] -= 1.0; } }", "", "f")


def test_a_step_of_nothing_costs_nothing():
    assert str(Operations({})) == "0 + −, 0 ×, 0 ÷"
