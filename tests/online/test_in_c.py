"""The recursive estimator in C computes what it computes in Python."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import exoid
from exoid import Armature, Coulomb, ExoidError, Offset, Stiffness, Viscous
from exoid.control.parameter_change import point_masses
from exoid.online import RecursiveEstimator, hypotheses_of
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
    out[2 * ONLINE_PARAMETERS + 2 * ONLINE_JOINTS] = (double)state->late;
#ifdef ONLINE_HYPOTHESES
    out[2 * ONLINE_PARAMETERS + 2 * ONLINE_JOINTS + 1] = (double)state->changes;
    out[2 * ONLINE_PARAMETERS + 2 * ONLINE_JOINTS + 2] = (double)state->hypothesis;
    out[2 * ONLINE_PARAMETERS + 2 * ONLINE_JOINTS + 3] = (double)state->change_block;
    out[2 * ONLINE_PARAMETERS + 2 * ONLINE_JOINTS + 4] = state->statistic;
#endif
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
        """Take a sample in; 1 when values are new."""
        return self.library.online_update(self.state, pointer(q), pointer(tau))

    def get(self):
        """Values, their standard deviations, weights and numbers of rows."""
        out = np.zeros(2 * (self.count + self.n) + 5)
        self.library.get(self.state, pointer(out))
        *found, rest = np.split(out, np.cumsum([self.count, self.count, self.n, self.n]))
        self.late, self.changes, self.hypothesis, self.change_block = rest[:4].astype(int).tolist()
        self.statistic = float(rest[4])
        return found

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


FAST = {"memory": 5.0}
SETTINGS = [
    {"estimator": "wls"},
    {"estimator": "ols"},
    {"reversal_speed": 0.3, "torque_limits": np.array([25.0, 12.0, 4.0])},
    {"terms": (Coulomb(dead_band=0.2), Viscous())},
    {"forgetting": "exponential", **FAST},
    {"forgetting": "directional", **FAST},
    {"forgetting": "directional", "false_alarms": 0.1, "reversal_speed": 0.3, **FAST},
]


def follow(c, online, q, tau, of_std=1e-9):
    """Compare values, standard deviations, weights and numbers of rows whenever C says that they are new."""
    blocks = 0
    for k in range(len(q)):
        if c.update(q[k], tau[k]) == 1:
            blocks, state = blocks + 1, online.state
            values, std, weights, count = c.get()
            np.testing.assert_allclose(values, state.values, rtol=0.0, atol=1e-9 * np.abs(state.values).max())
            np.testing.assert_allclose(std, state.std, rtol=of_std)
            np.testing.assert_allclose(weights, state.weights, rtol=1e-9)
            np.testing.assert_allclose(count, state.information.rows[:-1], rtol=1e-12)
        online.update(q[k], None, None, tau[k])  # afterwards: the work of C is complete before the next block
    assert c.late == 0
    return blocks


@pytest.mark.parametrize("changes", SETTINGS)
def test_values_of_every_block_are_those_of_python_on_recorded_input(swing, tmp_path, changes):
    log, online = swing.train, estimator_of(swing.leg, **changes)
    q, tau = (np.ascontiguousarray(x)[:1000] for x in (log.q, log.tau))
    assert follow(InC(online, tmp_path), online, q, tau) > 60
    assert np.isfinite(online.state.std).all()


def test_an_estimate_to_start_with(swing, tmp_path):
    """Of which the covariance stands in the place of what was known, and is forgotten with the rows."""
    start = exoid.identify(swing.leg, swing.train, check=False)
    start = replace(start, bounded=(), values=1.05 * start.values)
    online = estimator_of(swing.leg, start=start, forgetting="directional", false_alarms=0.1, **FAST)
    c = InC(online, tmp_path)
    np.testing.assert_array_equal(c.get()[0], start.values)
    q, tau = (np.ascontiguousarray(x)[:500] for x in (swing.train.q, swing.train.tau))
    assert follow(c, online, q, tau) > 30


def walking(model, beta, seed=0):
    """Two sines at each joint at 100 Hz, with random torque; the parameters are those of their stretch."""
    length, time = [len(part) for part in beta], np.arange(sum(len(part) for part in beta))[:, None] / 100.0
    phase, (q, v, a) = np.array([0.0, 1.0, 2.0]), np.zeros((3, sum(length), 3))
    for size, frequency in (((0.4, 0.5, 0.3), (0.6, 0.83, 1.1)), ((0.15, 0.2, 0.1), (1.3, 1.57, 1.9))):
        w = 2.0 * np.pi * np.array(frequency)
        q += size * np.sin(w * time + phase)
        v += size * w * np.cos(w * time + phase)
        a -= size * w**2 * np.sin(w * time + phase)
    torque = np.einsum("njp,np->nj", model.regressor(q, v, a), np.concatenate(beta))
    return q, torque + 0.3 * np.random.default_rng(seed).standard_normal(q.shape)


@pytest.mark.parametrize("forgetting", ["directional", pytest.param("exponential", marks=pytest.mark.slow)])
def test_changes_are_detected_in_the_same_block_and_values_after_them_are_the_same(tmp_path, forgetting):
    """Friction of the knee doubles; then 1.5 kg are strapped to the shank."""
    leg = exoid.load_leg("bleex", inertias="cad")
    online = estimator_of(leg, (Coulomb(), Viscous()), forgetting=forgetting, false_alarms=0.1)
    names, model = online.names, online.settings.model
    before = np.concatenate([leg.parameters, np.array([2.0, 2.0, 1.0, 1.0, 1.0, 0.5])])
    rough = before * np.where([name in ("c0_knee", "d_knee") for name in names], 2.0, 1.0)
    loaded = rough.copy()
    loaded[:9] += 1.5 * point_masses(leg, 1, np.array([[0.0, 0.0, -0.2]]))[:, 0]
    beta = [np.tile(values, (count, 1)) for values, count in ((before, 2700), (rough, 2600), (loaded, 400))]
    q, tau = walking(model, beta)
    c = InC(online, tmp_path, flags=("-O2",))
    assert follow(c, online, q, tau, of_std=1e-8) > 500  # what was forgotten has 1e-6 of the information
    first, second = online.changes
    assert (first.kind, first.joint) == ("friction", leg.joint_names[1])
    assert (second.kind, second.joint) == ("load", leg.joint_names[1])
    assert c.changes == 2
    hypothesis = hypotheses_of(model)[c.hypothesis]
    assert (hypothesis.kind, hypothesis.joint) == (second.kind, second.joint)
    assert c.change_block * online.settings.block == second.sample
    assert c.statistic == pytest.approx(second.statistic, rel=1e-6)


@pytest.mark.slow
def test_noise_without_a_change_raises_no_alarm_in_either(tmp_path):
    leg = exoid.load_leg("bleex", inertias="cad")
    online = estimator_of(leg, (Coulomb(), Viscous()), forgetting="directional", false_alarms=0.1)
    beta = np.concatenate([leg.parameters, np.array([2.0, 2.0, 1.0, 1.0, 1.0, 0.5])])
    c = InC(online, tmp_path, flags=("-O2",))
    for q, tau in zip(*walking(online.settings.model, [np.tile(beta, (30_000, 1))], seed=1), strict=True):
        c.update(q, tau)
    c.get()
    assert (c.changes, c.late) == (0, 0)


@pytest.mark.parametrize("forgetting", ["none", "directional"])
def test_random_readings(tmp_path, forgetting):
    """Joints that jump from sample to sample: no motion of a leg, but the same numbers."""
    online = estimator_of(exoid.load_leg("bleex"), forgetting=forgetting, **FAST)
    q, tau = np.random.default_rng(4).normal(0.0, 1.0, (2, 600, 3))
    assert follow(InC(online, tmp_path), online, 0.05 * q, 10.0 * tau) > 30


def test_the_torque_limits_of_the_test_above_leave_rows_out(swing):
    assert (np.abs(swing.train.tau[:1000]).max(axis=0) > np.array([25.0, 12.0, 4.0])).any()


def test_a_sample_that_is_not_finite_empties_the_filters_and_nothing_else(swing, tmp_path):
    log = swing.train
    online = estimator_of(swing.leg)
    c = InC(online, tmp_path)
    q, tau = np.ascontiguousarray(log.q), np.ascontiguousarray(log.tau)
    for k in range(1000):
        c.update(q[k], tau[k])
    for bad in (np.nan, np.inf, -np.inf, 1e10):
        assert c.update(np.full(3, bad), tau[0]) == -1
        assert c.update(q[0], np.array([0.0, bad, 0.0])) == -1
    c.library.online_solve(c.state)
    before = c.get()
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
    online = estimator_of(swing.leg, TERMS, forgetting="directional", false_alarms=0.1)
    source = write_recursive(tmp_path / "online.c", online)
    q = np.random.default_rng(2).normal(0.0, 1.0, (500, 6))
    q[::97, 1] = np.nan
    q.tofile(tmp_path / "in.bin")
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "online.h"\nint main(void)\n{\n    static online_state state;\n    double x[6];\n'
        '    FILE *file = fopen("in.bin", "rb");\n    online_init(&state);\n'
        "    while (file != NULL && fread(x, sizeof x, 1, file) == 1) {\n"
        "        online_update(&state, x, x + 3);\n    }\n"
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


def test_a_start_with_samples_is_refused_and_files_have_their_names(swing, tmp_path):
    start = replace(exoid.identify(swing.leg, swing.train, check=False), bounded=())
    used = estimator_of(swing.leg, start=start)
    used.update(swing.train.q[:300], None, None, swing.train.tau[:300])
    with pytest.raises(ExoidError, match="what a start and samples gave"):
        recursive_source(used)
    with pytest.raises(ExoidError, match=r"name it ONLINE\.c"):
        write_recursive(tmp_path / "online.txt", estimator_of(swing.leg))
    written = write_recursive(tmp_path / "left-leg.c", estimator_of(swing.leg))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["left-leg.c", "left_leg.h"]
    assert set(written.to_json()["files"]) == {"left-leg.c", "left_leg.h"}
    assert "left_leg_init, left_leg_update, left_leg_solve" in str(written)
