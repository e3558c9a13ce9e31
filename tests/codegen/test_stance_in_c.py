"""The law on the ground in C, with DAQP as its solver, equals the law in Python."""

import ctypes
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from compiled import COMPILER, made_up, needs_compiler
from compiled_laws import compile_laws, records

import exoid
from exoid.codegen import c_source
from exoid.control import stance
from exoid.control.ground import GroundState, GroundTarget, StanceLaw
from exoid.control.ground.model import BRAKE
from exoid.rig.ground import GroundPlant
from exoid.rig.ground.plant import BLEEX_SOLES, CUHK_SOLES, SEAT

daqp = pytest.importorskip("daqp")
pytestmark = needs_compiler

KINDS = {"flat": 1.0, "heel": 2.0, "toe": 3.0}
FRICTION = {"c0_left_knee": 1.5, "d_right_hip": 0.8, "Ia_left_hip": 0.2, "b1_right_knee": 4.0, "b0_left_hip": -1.0}
PLACES = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)


@ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_int, *[PLACES[0]] * 5, PLACES[1], *[PLACES[0]] * 2)
def solve(n, m, H, f, A, upper, lower, soft, x, multiplier):
    """DAQP as the solver that the C asks for."""
    H, A = (np.ctypeslib.as_array(each, shape).copy() for each, shape in ((H, (n, n)), (A, (m, n))))
    f, upper, lower, soft = (
        np.ctypeslib.as_array(each, (count,)).copy() for each, count in ((f, n), (upper, m), (lower, m), (soft, m))
    )
    lower[lower <= -1e30] = -np.inf
    sense = np.where(soft > 0, 8, 0).astype(np.intc)
    found, _, flag, told = daqp.solve(H, f, A, upper, lower, sense)
    np.ctypeslib.as_array(x, (n,))[:], np.ctypeslib.as_array(multiplier, (m,))[:] = found, told["lam"]
    return flag


def bleex() -> StanceLaw:
    soles = {**BLEEX_SOLES, "torso": SEAT}
    plant = GroundPlant.build(exoid.load_exo("bleex", base="floating"), soles, FRICTION)
    return stance(plant, kp=(80.0, 90.0, 60.0, 80.0, 90.0, 60.0, 70.0), kd=15.0, power=400.0)


def cuhk() -> StanceLaw:
    plant = GroundPlant.build(exoid.load_exo("cuhk", base="floating"), CUHK_SOLES, FRICTION)
    return stance(plant, friction=None)


def drawn(law: StanceLaw, rng: np.random.Generator) -> tuple[GroundState, GroundTarget]:
    """Random pose, contacts, shares, wearer and reference."""
    n, links = law.model.n, [*law.model.soles]
    touching = rng.permutation(links)[: rng.integers(1, len(links) + 1)]
    contacts = {str(link): str(rng.choice([*KINDS])) if rng.random() < 0.4 else "flat" for link in touching}
    shares = {link: float(rng.choice([1.0, rng.uniform(0.0, 1.0), 0.02])) for link in contacts}
    q, q_d = rng.uniform(-0.2, 0.2, (2, n)) + np.resize([0.3, -0.6, 0.3] if n == 6 else [0.3, 0.6], n)
    v, v_d, a_d = rng.uniform(-1.0, 1.0, (3, n))
    pitches, push = rng.uniform(-0.3, 0.3, 5), rng.normal(0.0, rng.choice([20.0, 600.0]), 3)
    state = GroundState(q, v, *pitches[:2], contacts, shares, rng.normal(0, 5, n), push, pitches[2] / 3)
    return state, GroundTarget(q_d, v_d, a_d, *pitches[3:], rng.normal())


def values_of(law: StanceLaw, state: GroundState, target: GroundTarget) -> dict[str, object]:
    """Inputs of the C."""
    links = [*law.model.soles]
    return {
        **{name: getattr(state, name) for name in ("q", "v", "interaction", "push", "lean")},
        "pitch": (state.pitch, state.pitch_rate),
        "contact": [KINDS.get(state.contacts.get(link), 0.0) for link in links],
        "share": [state.shares.get(link, 1.0) for link in links],
        **{"q_d": target.q, "v_d": target.v, "a_d": target.a},
        "pitch_d": (target.pitch, target.pitch_rate, target.pitch_acceleration),
        "solve": ctypes.cast(solve, ctypes.c_void_p).value,
    }


@pytest.fixture(scope="module", params=[bleex, cuhk])
def compiled(request, tmp_path_factory):
    """The law, and its C."""
    law, folder = request.param(), tmp_path_factory.mktemp("stance")
    source = c_source(law, name="stand")
    return law, compile_laws([source], folder)["stand"]


@pytest.fixture(scope="module")
def from_the_page(tmp_path_factory):
    """The solver of docs/stance-control.md, if the compiler finds DAQP's C library (CPATH, LIBRARY_PATH)."""
    page, folder = Path(__file__).resolve().parents[2] / "docs" / "stance-control.md", tmp_path_factory.mktemp("daqp")
    lines = re.search(r"```c\n(#include <daqp/api.h>.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    (folder / "solver.c").write_text(lines[1].replace("static int", "int"), encoding="utf-8")
    there = [COMPILER, "-E", "-include", "daqp/api.h", "-x", "c", "/dev/null"]
    if subprocess.run(there, capture_output=True, check=False).returncode:
        pytest.skip("needs DAQP's C library")
    arguments = ("-std=c99", "-Wall", "-Werror", "-fPIC", "-shared", "solver.c", "-ldaqp", "-lm", "-o", "solver.so")
    subprocess.run([COMPILER, *arguments], cwd=folder, check=True)
    return ctypes.cast(ctypes.CDLL(str(folder / "solver.so")).by_daqp, ctypes.c_void_p).value


@pytest.mark.parametrize("solver", [None, "from_the_page"], ids=["Python's", "docs"])
def test_c_is_the_law_in_random_states(compiled, solver, request):
    """As far as Python is itself when its inputs move by 1e-15: several contacts hold some direction nearly twice."""
    law, in_c = compiled
    given = {} if solver is None else {"solve": request.getfixturevalue(solver)}
    rng, off, infeasible = np.random.default_rng(1000), {1: [], 2: [], 3: []}, 0
    for _ in range(200):
        state, target = drawn(law, rng)
        expected = law.command(state, target)
        tau, status, _ = in_c.run(records(in_c.source, 1, {**values_of(law, state, target), **given}))
        assert status[0] == 0
        infeasible += not expected.feasible
        moves = rng.uniform(-1e-15, 1e-15, (4, 2, law.model.n))
        moved = [law.command(state._replace(q=state.q + dq, v=state.v + dv), target).torque for dq, dv in moves]
        off[len(state.contacts)].append([np.abs(x - expected.torque).max() for x in (tau[0], moved)])
    largest = {count: np.max(x, axis=0) / np.abs(law.limit).max() for count, x in off.items() if x}
    shown = "; ".join(f"{count}: {in_c:.1e}, {moved:.1e}" for count, (in_c, moved) in largest.items())
    print(f"{infeasible} infeasible; largest difference of C, and of moved inputs, by number of contacts: {shown}")
    assert largest[1][0] < 1e-11
    assert all(in_c < max(1e-12, 5.0 * moved) for count, (in_c, moved) in largest.items() if count > 1)
    assert np.max([*largest.values()]) < 2e-10  # rows that are missed let the torque jump: a seat alone, pushed hard
    assert infeasible > 10


@ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_int, *[PLACES[0]] * 5, PLACES[1], *[PLACES[0]] * 2)
def solve_only(n, m, H, f, A, upper, lower, soft, x, multiplier):
    """DAQP without its multipliers."""
    return solve(n, m, H, f, A, upper, lower, soft, x, (ctypes.c_double * m)())


def test_a_solver_may_leave_the_multipliers_alone(compiled):
    (law, in_c), rng = compiled, np.random.default_rng(1000)
    for _ in range(20):
        state, target = drawn(law, rng)
        values = values_of(law, state, target) | {"solve": ctypes.cast(solve_only, ctypes.c_void_p).value}
        tau, _, _ = in_c.run(records(in_c.source, 1, values))
        np.testing.assert_allclose(tau[0], law.command(state, target).torque, atol=1e-4)


@pytest.mark.parametrize("change", [{"contact": 0.0}, {"solve": 0}, {"share": -0.5}, {"contact": 4.0}], ids=str)
def test_without_support_or_solver_or_with_what_python_refuses_joints_are_damped(compiled, change):
    law, in_c = compiled
    values = {**values_of(law, *drawn(law, np.random.default_rng(0))), **change}
    tau, status, _ = in_c.run(records(in_c.source, 1, values))
    assert status[0] != 0
    np.testing.assert_allclose(tau[0], -BRAKE * values["v"])


def test_single_precision_is_refused():
    with pytest.raises(exoid.ExoidError, match="single precision"):
        c_source(cuhk(), precision="float")


def test_the_command_writes_the_law_of_a_machine_on_the_ground(exoid_, tmp_path):
    machine, model = exoid.load_exo("bleex", base="floating"), exoid.load_leg("bleex")
    for name, leg in (("stands", machine), ("held", model)):
        made_up(leg, (exoid.Viscous(),)).save(tmp_path / f"{name}.json")
    for law in ("coordinated", "stance"):
        assert exoid_("export", "stands.json", "--law", law, "--limit", "90", "--c", "law.c").printed
    assert "law_largest" in (tmp_path / "law.c").read_text()
    assert "solve" in (tmp_path / "law.h").read_text()
    refusal = exoid_("export", "held.json", "--law", "stance", "--c", "other.c").refusal
    assert "base that floats" in refusal
