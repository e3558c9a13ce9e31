"""Laws in C compute what they compute in Python, and end in the safe torque whatever the input."""

import shutil
import subprocess

import numpy as np
import pytest
from compiled import needs_compiler
from compiled_laws import build, compile_laws, records, write_all
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from laws_of_bleex import KD, LIMIT, laws, model, observer, random_values, torques_in_python
from planar_chains import assert_relative

from exoid.codegen import Safety, c_source
from exoid.control import default_gains

pytestmark = needs_compiler

EXACT, SINGLE = 1e-12, 1e-5
"""Largest error allowed in double and in float, relative to the largest torque."""

NAMES = tuple(laws())
SAFE = {"gravity_friction_pd": "gravity", "computed_torque": "zero", "passive_ankle": "zero", "lqr": "gravity"}
"""Safe torque of laws that do not have the default one."""


def source_of(name, precision="double"):
    safety = Safety(SAFE.get(name, "damping"))
    return c_source(laws()[name], name=f"{name}_{precision}", precision=precision, safety=safety)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """All laws in both precisions, compiled once."""
    folder = tmp_path_factory.mktemp("laws")
    sources = [source_of(name, precision) for name in NAMES for precision in ("double", "float")]
    sources.append(c_source(observer(), name="momentum_observer_double"))
    return compile_laws(sources, folder)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("precision", "tolerance"), [("double", EXACT), ("float", SINGLE)])
def test_a_law_computes_the_same_on_random_input(library, name, precision, tolerance):
    law, values = library[f"{name}_{precision}"], random_values(150)
    tau, status, _ = law.run(records(law.source, 150, values))
    assert not status.any()
    assert_relative(tau, torques_in_python(laws()[name], values), tolerance)


SANITIZERS = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_sanitizers_find_nothing_and_every_compiler_computes_the_same(library, tmp_path, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    flags = SANITIZERS if has_sanitizers(compiler, tmp_path) else ()
    rng, inputs = np.random.default_rng(1), {}
    for name in (*NAMES, "momentum_observer"):
        rows = records(library[f"{name}_double"].source, 60, random_values(60, seed=2))
        for row in rows[::4]:
            spoil(row, rng)
        rows.tofile(tmp_path / f"{name}_double.in")
        inputs[f"{name}_double"] = rows
    text = write_all([library[prefix].source for prefix in inputs], tmp_path, main=True)
    program = build(compiler, flags, text, tmp_path / "all_laws")
    done = subprocess.run([str(program)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    for prefix, rows in inputs.items():
        tau = np.fromfile(tmp_path / f"{prefix}.out").reshape(-1, 3)
        assert_relative(tau, library[prefix].run(rows)[0], EXACT)
    if not flags:
        pytest.skip(f"{compiler} has no sanitizers here: compiled and run without")


def has_sanitizers(compiler, folder):
    """Whether the compiler's libraries for its sanitizers are installed."""
    (folder / "empty.c").write_text("int main(void) { return 0; }")
    command = [compiler, *SANITIZERS, str(folder / "empty.c"), "-o", str(folder / "empty")]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def spoil(row, rng):
    """Put a number that no sensor gives into one place."""
    numbers = [name for name in row.dtype.names if name not in ("reading", "target")]
    name = numbers[rng.integers(len(numbers))]
    wrong = rng.choice([np.nan, np.inf, -np.inf, 1e300, -1e30])
    if row[name].ndim:
        row[name][rng.integers(len(row[name]))] = wrong
    else:
        row[name] = wrong


def safe_torque(name, row, valid):
    """What the torque should be where an input is wrong, before the limits."""
    kind = SAFE.get(name, "damping")
    tau = model().statics(valid) if kind == "gravity" else np.zeros(3)
    if kind != "zero" and (np.abs(row["v"]) <= 1e9).all():
        tau = tau - damping(name) * row["v"]
    return tau


def damping(name):
    if name in ("pd", "gravity_friction_pd", "feedforward_pd"):
        return KD
    return np.zeros(3) if name == "gravity_only" else default_gains(model(), np.zeros(3))[1]


@given(
    seed=st.integers(0, 2**32 - 1),
    name=st.sampled_from(NAMES),
    wrong=st.sampled_from([np.nan, np.inf, -np.inf, 1e300, 2e9]),
)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_number_that_is_not_finite_ends_in_the_safe_torque(library, seed, name, wrong):
    rng, law = np.random.default_rng(seed), library[f"{name}_double"]
    values = random_values(3, seed)
    rows = records(law.source, 3, values)
    numbers = [field for field in rows.dtype.names if field not in ("reading", "target")]
    field = numbers[rng.integers(len(numbers))]
    rows[field][1, ...] = np.where(rng.random(rows[field][1].shape) < 0.5, wrong, rows[field][1])
    rows[field][(1, *(0,) * (rows[field].ndim - 1))] = wrong
    tau, status, _ = law.run(rows)
    kinds = {"q": 1, "v": 1, "interaction": 1}
    assert status.tolist() == [0, kinds.get(field, 3), 0]
    assert np.isfinite(tau).all()
    valid = values["q"][0] if field in kinds else values["q"][1]
    expected, limits = safe_torque(name, rows[1], valid), laws()[name]
    slew = np.asarray(getattr(limits, "slew", np.inf)) / law.rate
    limit = np.asarray(getattr(limits, "limit", np.inf))
    expected = np.clip(np.clip(expected, tau[0] - slew, tau[0] + slew), -limit, limit)
    np.testing.assert_allclose(tau[1], expected, atol=1e-12 * max(1.0, np.abs(expected).max()))
    after = {key: x[2:] for key, x in values.items()}
    assert_relative(tau[2:], torques_in_python(laws()[name], after, last=tau[1]), EXACT)


@pytest.mark.parametrize(("counter", "code"), [("reading", 2), ("target", 4)])
def test_an_input_that_stands_still_is_stale_after_the_patience(library, counter, code):
    law, values = library["pd_double"], random_values(20)
    rows = records(law.source, 20, values)
    rows[counter][6:14] = rows[counter][5]  # eight samples without a new input, five of which are allowed
    tau, status, _ = law.run(rows)
    assert status.tolist() == [0] * 11 + [code] * 3 + [0] * 6
    damped = np.clip(-KD * values["v"][11:14], -LIMIT, LIMIT)
    np.testing.assert_allclose(tau[11:14], 0.0 * damped if counter == "reading" else damped, atol=1e-12)


def test_before_the_first_input_the_torque_is_safe(library):
    law = library["gravity_friction_pd_double"]
    rows = records(law.source, 3, random_values(3))
    rows["reading"] = rows["target"] = 0
    tau, status, _ = law.run(rows)
    assert status.tolist() == [2, 2, 2]
    assert not tau.any()


def test_counters_may_overflow(library):
    law = library["pd_double"]
    rows = records(law.source, 6, random_values(6))
    rows["reading"] = rows["target"] = np.arange(2**32 - 3, 2**32 + 3, dtype=np.uint64).astype(np.uint32)
    assert not law.run(rows)[1].any()
