"""Adaptive control in C computes and learns what it does in Python, and ends in the safe torque whatever the input."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest
from compiled import COMPILER, needs_compiler
from compiled_laws import CompiledLaw, build, records, write_all
from laws_of_bleex import KD, KP, LIMIT, SLEW, random_values, target_of

import exoid
from exoid import Armature, Coulomb, ExoidError, Offset, Viscous
from exoid.codegen.laws import Safety
from exoid.control import Limited, State, adaptive, simulate, stateful
from exoid.control.in_c import adaptive as described
from exoid.control.in_c import c_source
from exoid.control.parameter_change import point_masses
from exoid.control.track import SENSORS
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.rig import Plant
from exoid.torques import Stribeck

pytestmark = needs_compiler

SWING = exoid.datasets.bleex_swing()
LEG = exoid.load_leg("bleex", inertias="identified")


@pytest.fixture(scope="module")
def laws():
    """Slotine and Li's controller, and the composite one, of an estimate with friction and rotors; and of a leg."""
    terms = (Coulomb(), Viscous(), Offset(), Armature())
    estimate = exoid.identify(SWING.leg, SWING.train, terms=terms, check=False)
    return {
        "slotine_li": adaptive(estimate, KP, KD, prediction=None),
        "composite": adaptive(estimate, KP, KD),
        "leg": Limited(adaptive(LEG, KP, KD), LIMIT, SLEW),
    }


@pytest.fixture(scope="module")
def library(laws, tmp_path_factory):
    folder = tmp_path_factory.mktemp("adaptive")
    safe = {"leg": Safety("gravity")}
    sources = [c_source(law, name=name, safety=safe.get(name)) for name, law in laws.items()]
    path = build(COMPILER, ("-O1", "-shared", "-fPIC"), write_all(sources, folder), folder / "adaptive.so")
    return {source.prefix: CompiledLaw(source, ctypes.CDLL(str(path))) for source in sources}


def in_python(law, values, last=None):
    """Torques and the last parameters."""
    law = stateful(law)
    states = [State(q, v, float(t)) for q, v, t in zip(values["q"], values["v"], values["time"], strict=True)]
    memory, found = law.begin(states[0]), []
    for k, state in enumerate(states):
        last, memory = law.step(memory, state._replace(last=last), target_of(values, k))
        found.append(last)
    return np.array(found), memory.values


def skipped(law, memory):
    """Samples that taught nothing, from the bytes of the state: the last torque, what the safe torque keeps, memory."""
    sizes = {array.name: array.values.size for array in law.source.law.memory}
    names = list(sizes)
    n = len(law.source.law.joints)
    kept = n + 1 if law.source.safety.safe == "gravity" else 0  # valid angles, and whether there are any
    before = n + kept + sum(sizes[name] for name in names[: names.index("skipped")])
    return int(np.frombuffer(memory[: 8 * before + 8])[before])


def recorded(count):
    q, time = np.asarray(SWING.train.q)[:count], np.asarray(SWING.train.time)[:count]
    v = np.gradient(q, time, axis=0)
    return {"q": q, "v": v, "q_d": q + 0.05, "v_d": 0.9 * v, "a_d": np.gradient(v, time, axis=0), "time": time}


TOLERANCES = [
    ("slotine_li", 1e-11),
    ("leg", 1e-12),
    ("composite", 1e-11),
]


@pytest.mark.parametrize(("name", "tolerance"), TOLERANCES)
@pytest.mark.parametrize("kind", ["random", "recorded"])
def test_torques_and_parameters_are_those_of_python(library, laws, name, tolerance, kind):
    values = random_values(60) if kind == "random" else recorded(120)
    tau, status, memory = library[name].run(records(library[name].source, len(values["q"]), values))
    assert not status.any()
    assert skipped(library[name], memory) == 0
    expected, parameters = in_python(laws[name], values)
    np.testing.assert_allclose(tau, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())
    law = getattr(laws[name], "law", laws[name])
    assert np.abs(parameters - law.start).max() > 0.02 * np.abs(law.start).max()  # it has learnt


def test_samples_whose_projection_takes_too_long_teach_nothing_and_are_counted(laws, tmp_path, monkeypatch):
    """With 20 steps at most; some of these 60 samples need more, one of them more than 30."""
    monkeypatch.setattr(described, "LEAST_STEPS", 20)
    monkeypatch.setattr(described, "STEPS_PER_PARAMETER", 0)
    source, values = c_source(laws["composite"], name="hasty"), random_values(60)
    path = build(COMPILER, ("-O1", "-shared", "-fPIC"), write_all([source], tmp_path), tmp_path / "hasty.so")
    law = CompiledLaw(source, ctypes.CDLL(str(path)))
    rows, count, memory = records(source, 60, values), len(laws["composite"].names), law.fresh()
    seen = []
    for k in range(60):
        tau, status, after = law.run(rows[k : k + 1], memory)
        assert status[0] == 0
        assert np.isfinite(tau).all()
        if skipped(law, after) > skipped(law, memory):
            old, new = (np.frombuffer(x[: 8 * (3 + count)])[3:] for x in (memory, after))
            np.testing.assert_array_equal(new, old)
            seen.append(k)
        memory = after
    assert 0 < len(seen) == skipped(law, memory) < 20


@pytest.mark.parametrize(
    "name",
    ["leg", pytest.param("composite", marks=pytest.mark.slow), pytest.param("slotine_li", marks=pytest.mark.slow)],
)
def test_in_the_closed_loop_on_the_rig_c_tracks_like_python(library, laws, name):
    """With 1.5 kg on the shank that the law does not know."""
    loaded = LEG.with_parameters(LEG.parameters + 1.5 * point_masses(LEG, 1, np.array([[0.0, 0.0, -0.2]]))[:, 0])
    plant = Plant.build(loaded, {f"{symbol}_{joint}": 1.0 for joint in LEG.joint_labels for symbol in ("c0", "d")})
    gait = gait_for_leg(LEG, healthy_gait(0.8, 2.0))
    runs = [simulate(plant, law, gait, 1.0, sensors=SENSORS, seed=1) for law in (laws[name], library[name])]
    expected, found = ([run.rms_deg, run.peak_deg, run.rms_torque] for run in runs)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    np.testing.assert_allclose(runs[1].tau, runs[0].tau, atol=1e-6 * np.abs(runs[0].tau).max())


@pytest.mark.parametrize("name", ["slotine_li", "leg"])
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e300])
@pytest.mark.parametrize(("field", "code"), [("q", 1), ("v", 1), ("q_d", 3), ("a_d", 3)])
def test_an_input_that_is_not_finite_ends_in_the_safe_torque_and_the_law_begins_again(
    library, laws, name, wrong, field, code
):
    law, values = library[name], random_values(24)
    rows = records(law.source, 24, values)
    rows[field][10, 1] = wrong
    tau, status, _ = law.run(rows)
    assert status.tolist() == [0] * 10 + [code] + [0] * 13
    assert np.isfinite(tau).all()
    if name == "slotine_li":
        damped = -KD * values["v"][10] if field != "v" else np.zeros(3)
        np.testing.assert_allclose(tau[10], damped, atol=1e-12 * np.abs(damped).max())
    expected, _ = in_python(laws[name], {key: x[11:] for key, x in values.items()}, last=tau[10])
    np.testing.assert_allclose(tau[11:], expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


def test_huge_but_plausible_numbers_leave_the_torque_finite_and_the_parameters_possible(library, laws):
    law, values = library["leg"], random_values(40)
    rows = records(law.source, 40, values)
    rows["v"][10:20] = 9e8
    rows["a_d"][12:22] = -9e8
    tau, _, _ = law.run(rows)
    assert np.isfinite(tau).all()
    assert (np.abs(tau) <= LIMIT).all()


def test_a_reading_that_stands_still_is_stale(library):
    law, values = library["slotine_li"], random_values(20)
    rows = records(law.source, 20, values)
    rows["reading"][6:] = rows["reading"][5]
    tau, status, _ = law.run(rows)
    assert status.tolist() == [0] * 11 + [2] * 9
    assert not tau[11:].any()


def test_operations_in_the_worst_case_are_counted(library):
    """All steps of the projection; composite adaptation adds a regressor and the information matrix."""
    plain, composite = (library[name].source.operations.by_kind for name in ("slotine_li", "composite"))
    assert composite["×"] > plain["×"] > 1e5
    assert composite["cos"] == composite["sin"] == 2 * plain["sin"] == 2 * 9
    assert composite["tanh"] == 2 * plain["tanh"] == 2 * 3


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_sanitizers_find_nothing_and_every_compiler_computes_the_same(library, tmp_path, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"needs {compiler}")
    inputs = {}
    for name in ("slotine_li", "leg"):
        rows = inputs[name] = records(library[name].source, 40, random_values(40, seed=2))
        rows["v"][7::9, 1], rows["q_d"][5::11, 0] = np.nan, -np.inf
        rows.tofile(tmp_path / f"{name}.in")
    text = write_all([library[name].source for name in inputs], tmp_path, main=True)
    flags = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
    program = build(compiler, flags, text, tmp_path / "adaptive")
    done = subprocess.run([str(program)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    for name, rows in inputs.items():
        tau, expected = np.fromfile(tmp_path / f"{name}.out").reshape(-1, 3), library[name].run(rows)[0]
        np.testing.assert_allclose(tau, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


def test_single_precision_and_terms_that_are_not_adapted_are_refused():
    with pytest.raises(ExoidError, match="in float"):
        c_source(adaptive(LEG, KP, KD), precision="float")
    estimate = exoid.identify(SWING.leg, SWING.train, terms=(Coulomb(), Viscous(), Stribeck()), check=False)
    with pytest.raises(ExoidError, match="Stribeck is not adapted"):
        c_source(adaptive(estimate, KP, KD))
