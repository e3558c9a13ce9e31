"""The core of the recursive estimator in C computes what it computes in Python."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import exoid
from exoid import Armature, Coulomb, ExoidError, Offset, Stiffness, Viscous
from exoid.online import RecursiveEstimator
from exoid.online.in_c import recursive_source, write_recursive
from exoid.torques import DEFAULT_TERMS, CouplingSpring

COMPILER = shutil.which("cc")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc)")

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion", "-Wshadow", "-Wstrict-prototypes")

RUNNER = """
#include "online.c"
int size(void);
void get(const online_state *state, double *out);
void rows(const double *q, const double *v, const double *a, double *W);

int size(void)
{
    return (int)sizeof(online_state);
}

void get(const online_state *state, double *out)
{
    int k;
    for (k = 0; k < ONLINE_PARAMETERS; ++k) {
        out[k] = state->values[k];
        out[ONLINE_PARAMETERS + k] = state->std[k];
    }
    for (k = 0; k < ONLINE_JOINTS; ++k) {
        out[2 * ONLINE_PARAMETERS + k] = state->weights[k];
        out[2 * ONLINE_PARAMETERS + ONLINE_JOINTS + k] = state->count[k];
    }
}

void rows(const double *q, const double *v, const double *a, double *W)
{
    double found[ONLINE_JOINTS][ONLINE_PARAMETERS];
    int j, k;
    online_regressor(q, v, a, found);
    for (j = 0; j < ONLINE_JOINTS; ++j) {
        for (k = 0; k < ONLINE_PARAMETERS; ++k) {
            W[j * ONLINE_PARAMETERS + k] = found[j][k];
        }
    }
}
"""

TERMS = (
    Coulomb(),
    Viscous(),
    Armature(),
    Offset(joints=("ankle",)),
    Stiffness(degree=3, joints=("knee",)),
    CouplingSpring(joints=("knee", "hip"), ratios=(1.0, -0.6)),
)


class InC:
    """An estimator in C, sample by sample."""

    def __init__(self, estimator, folder, flags=("-O1",)):
        source = recursive_source(estimator)
        (folder / "online.h").write_text(source.header)
        (folder / "online.c").write_text(source.source)
        (folder / "run.c").write_text(RUNNER)
        command = [COMPILER, *STRICT, *flags, "-shared", "-fPIC", folder / "run.c", "-o", folder / "run.so", "-lm"]
        done = subprocess.run([str(each) for each in command], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        self.library = ctypes.CDLL(str(folder / "run.so"))
        self.n, self.count = estimator.settings.n, estimator.settings.count
        self.state = ctypes.create_string_buffer(self.library.size())
        self.library.online_init(self.state)

    def update(self, q, tau):
        """Take a sample in, and solve where a block is complete."""
        return self.library.online_update(self.state, pointer(q), pointer(tau))

    def get(self):
        """Values, their standard deviations, weights and numbers of rows."""
        out = np.zeros(2 * (self.count + self.n))
        self.library.get(self.state, pointer(out))
        return np.split(out, np.cumsum([self.count, self.count, self.n]))

    def rows(self, q, v, a):
        """Rows of the regressor."""
        W = np.zeros((self.n, self.count))
        self.library.rows(*(pointer(np.ascontiguousarray(x)) for x in (q, v, a)), pointer(W))
        return W


def pointer(array):
    return array.ctypes.data_as(ctypes.c_void_p)


def estimator_of(leg, terms=None, **changes):
    settings = {"rate": 100.0, "cutoff": 6.0, "forgetting": "none", "false_alarms": 0.0}
    return RecursiveEstimator(leg, terms, **{**settings, **changes})


@pytest.fixture(scope="module")
def swing():
    return exoid.datasets.bleex_swing()


@pytest.mark.parametrize(("name", "terms"), [("bleex", TERMS), ("cuhk", DEFAULT_TERMS)])
def test_the_regressor_in_closed_form_is_that_of_the_model(tmp_path, name, terms):
    online = estimator_of(exoid.load_leg(name), terms)
    c, model = InC(online, tmp_path), online.settings.model
    for q, v, a in np.random.default_rng(0).normal(0.0, 2.0, (20, 3, online.settings.n)):
        expected = model.regressor(q[None], v[None], a[None])[0]
        np.testing.assert_allclose(c.rows(q, v, a), expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize(
    "changes",
    [
        {"estimator": "wls"},
        {"estimator": "ols"},
        {"reversal_speed": 0.3, "torque_limits": np.array([25.0, 12.0, 4.0])},
        {"terms": (Coulomb(dead_band=0.2), Viscous())},
    ],
)
def test_values_of_every_block_are_those_of_python_on_recorded_input(swing, tmp_path, changes):
    log, online = swing.train, estimator_of(swing.leg, **changes)
    c, blocks = InC(online, tmp_path), 0
    for q, tau in zip(np.ascontiguousarray(log.q)[:1500], np.ascontiguousarray(log.tau)[:1500], strict=True):
        complete = c.update(q, tau)
        online.update(q, None, None, tau)
        if not complete:
            continue
        blocks += 1
        state = online.state
        values, std, weights, count = c.get()
        np.testing.assert_array_equal(count, state.information.rows[:-1])
        if np.isfinite(state.std[0]):
            np.testing.assert_allclose(values, state.values, rtol=0.0, atol=1e-9 * np.abs(state.values).max())
            np.testing.assert_allclose(std, state.std, rtol=1e-9)
            np.testing.assert_allclose(weights, state.weights, rtol=1e-9)
        else:
            assert (std == -1.0).all()
    assert blocks > 100
    assert np.isfinite(online.state.std).all()


def test_the_torque_limits_of_the_test_above_leave_rows_out(swing):
    assert (np.abs(swing.train.tau[:1500]).max(axis=0) > np.array([25.0, 12.0, 4.0])).any()


def test_a_sample_that_is_not_finite_empties_the_filters_and_nothing_else(swing, tmp_path):
    log = swing.train
    online = estimator_of(swing.leg)
    c = InC(online, tmp_path)
    q, tau = np.ascontiguousarray(log.q), np.ascontiguousarray(log.tau)
    for k in range(1000):
        c.update(q[k], tau[k])
    before = c.get()
    for bad in (np.nan, np.inf, -np.inf, 1e10):
        assert c.update(np.full(3, bad), tau[0]) == -1
        assert c.update(q[0], np.array([0.0, bad, 0.0])) == -1
    delay = round(1.5 * online.settings.delay * 100.0)  # of the 2 delays that the filters need, less their ends
    results = [c.update(q[k], tau[k]) for k in range(1000, 1000 + delay)]
    assert not any(results)  # rows come again when the filters are full
    for found, expected in zip(c.get(), before, strict=True):
        np.testing.assert_array_equal(found, expected)
    for k in range(1000 + delay, len(q)):
        c.update(q[k], tau[k])
    whole = estimator_of(swing.leg)
    whole.update(log.q, None, None, log.tau)
    np.testing.assert_array_less(np.abs(c.get()[0] - whole.state.values), 0.5 * whole.state.std)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_both_compilers_have_no_warning_and_sanitizers_find_nothing(swing, tmp_path, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    source = write_recursive(tmp_path / "online.c", estimator_of(swing.leg, TERMS))
    q = np.random.default_rng(2).normal(0.0, 1.0, (500, 6))
    q[::97, 1] = np.nan
    q.tofile(tmp_path / "in.bin")
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "online.h"\nint main(void)\n{\n    static online_state state;\n    double x[6];\n'
        '    FILE *file = fopen("in.bin", "rb");\n    online_init(&state);\n'
        "    while (file != NULL && fread(x, sizeof x, 1, file) == 1) {\n"
        "        if (online_update(&state, x, x + 3) == 1) {\n            online_solve(&state);\n        }\n    }\n"
        "    return file == NULL;\n}\n"
    )
    flags = (*STRICT, "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    done = subprocess.run(
        [compiler, *flags, "main.c", source.path.name, "-o", "main", "-lm"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    if "sanitize" in done.stderr or "cannot find" in done.stderr:
        pytest.skip(f"{compiler} has no sanitizers here")
    assert done.returncode == 0, done.stderr
    ran = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"forgetting": "directional"}, "forgetting='directional'"),
        ({"forgetting": "exponential"}, "forgetting='exponential'"),
        ({"false_alarms": 0.1}, "the change detection"),
        ({"cutoff": None}, "cutoff=None"),
        ({"nonnegative": True}, "nonnegative"),
        ({"consistent": True}, "consistent"),
    ],
)
def test_what_is_not_mirrored_is_refused_by_name(swing, tmp_path, changes, words):
    with pytest.raises(ExoidError, match="does not have") as refused:
        write_recursive(tmp_path / "online.c", estimator_of(swing.leg, **changes))
    assert words in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_a_start_is_refused_and_files_have_their_names(swing, tmp_path):
    start = replace(exoid.identify(swing.leg, swing.train, check=False), bounded=())
    with pytest.raises(ExoidError, match="an estimate to start with"):
        recursive_source(estimator_of(swing.leg, start=start))
    with pytest.raises(ExoidError, match=r"name it ONLINE\.c"):
        write_recursive(tmp_path / "online.txt", estimator_of(swing.leg))
    written = write_recursive(tmp_path / "left-leg.c", estimator_of(swing.leg))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["left-leg.c", "left_leg.h"]
    assert set(written.to_json()["files"]) == {"left-leg.c", "left_leg.h"}
    assert "left_leg_init, left_leg_update, left_leg_solve" in str(written)
