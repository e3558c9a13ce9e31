"""Coordinator, filter of contacts and law in C decide as in Python, and give the same torque."""

import ctypes
import os
from collections import defaultdict
from copy import deepcopy
from dataclasses import fields, replace
from itertools import chain, combinations, pairwise

import numpy as np
import pytest
from compiled import COMPILER, needs_compiler
from compiled_laws import CompiledLaw, build, records, state_type, write_all
from coordinated_runs import loop_of, run_of
from test_stance_in_c import solve

import exoid
from exoid.codegen import InputInC, LawInC, c_source
from exoid.control.functions import FUNCTIONS, Body
from exoid.control.ground import SAFE, ContactFilter, CoordinatedLoop, Coordinator
from exoid.control.ground.coordination_in_c import BEGIN, CONTACTS, coordinator_part, mask, wishes
from exoid.experiments.ground import bleex_machine
from exoid.lab.coordination import coordinate
from exoid.rig.ground import PASSIVE, Faults
from exoid.rig.ground.plant import BLEEX_SOLES
from exoid.rig.ground.plant import SEAT as SEAT_SOLE

pytestmark = needs_compiler

ALL_SETS = tuple(map(frozenset, chain.from_iterable(combinations(CONTACTS, k) for k in range(4))))
LEVELS = ("damping", "frozen", "support")


def alone(machine):
    """The coordinator alone, for contacts and a torque from outside."""
    part, names = coordinator_part(machine, ALL_SETS), tuple(f"joint {k}" for k in range(len(machine.limit)))
    code = """
    {{p}}_decide(state, in->chance, in->flexion, (int)in->wish[0], in->slips[0] > 0.5, in->broken[0] > 0.5);
    {{p}}_bound(state, in->wanted, in->v, tau);
    (void)j;"""
    own = (InputInC("chance", "of sets", "reading", 8), InputInC("flexion", "of legs", "reading", 6), *wishes(machine))
    inputs, parts = (*own, InputInC("wanted", "torque")), (part.tables, part.memory, BEGIN, part.helpers)
    law = LawInC(names, "coordinator", code, machine.rate, machine.limit, inputs, *parts, limit=machine.limit)
    return type("Alone", (), {"in_c": lambda self, dialect: law})()


def compiled(law, folder):
    source = c_source(law, name="walk")
    path = build(COMPILER, ["-shared", "-fPIC"], write_all([source], folder), folder / f"{len([*folder.iterdir()])}.so")
    return CompiledLaw(source, ctypes.CDLL(str(path)))


@pytest.fixture
def steps(monkeypatch):
    """Every step of every coordinator, by coordinator and memory: inputs, and what Python made of them."""
    found, alive, decide, bound = defaultdict(lambda: defaultdict(list)), [], Coordinator.decide, Coordinator.bound

    def decided(machine, memory, chances, flexion, request=None, **events):
        alive.append(memory)  # its id is not used again
        before = deepcopy(memory)
        decision = decide(machine, memory, chances, flexion, request, **events)
        found[machine][id(memory)].append([before, chances, flexion, request, events, decision])
        return decision

    def bounded(machine, memory, wanted, v):
        torque = bound(machine, memory, wanted, v)
        found[machine][id(memory)][-1] += [wanted, v, torque]
        return torque

    monkeypatch.setattr(Coordinator, "decide", decided)
    monkeypatch.setattr(Coordinator, "bound", bounded)
    return found


def check(law, machine, calls):
    """Equal decisions, and torque to 1e-12 of its limits: the largest difference."""
    names, state, off, first = [*machine.functions, SAFE], np.zeros((), state_type(law.source)), 0.0, calls[0][0]
    state["function"], state["known"] = names.index(first.function), mask(first.known)
    state["loaded"], state["running"] = [first.loaded.get(name, 0.0) for name in CONTACTS], 1
    for before, chances, flexion, request, events, decision, wanted, v, torque in calls:
        state["phase"] = before.phase  # the rig's reference moves it
        values = {"q": 0.0, "v": v, "flexion": np.ravel(flexion), "wanted": wanted}
        values["chance"] = [chances.get(each, 0.0) for each in ALL_SETS]
        values["wish"] = 0 if request is None else 1 + names.index(request)
        values |= {name: events.get(key, False) for name, key in (("slips", "lost"), ("broken", "broken"))}
        tau, status, raw = law.run(records(law.source, 1, values), state.tobytes())
        state = np.frombuffer(raw, state.dtype)[0].copy()
        state["reading_age"] = state["target_age"] = state["reading"] = state["target"] = 0
        shares = [decision.shares.get(name, 0.0) for name in CONTACTS]
        assert status[0] == 0
        assert (names[state["function"]], LEVELS[state["level"]]) == (decision.function, decision.level)
        assert abs(state["phase"] - decision.phase) < 1e-12
        np.testing.assert_allclose(state["share"], shares, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(np.sign(state["share"]), np.sign(shares))
        off = max(off, np.abs((tau[0] - torque) / machine.limit).max())
    assert off < 1e-12
    return off


def test_decisions_and_torque_in_random_events(steps, tmp_path):
    """Probabilities of a sojourn in each set, requests, postures, lost footings and made-up readings at random."""
    body = Body.of(exoid.load_exo("bleex", base="floating"), BLEEX_SOLES)
    functions = {name: make(body) for name, make in FUNCTIONS.items()}
    machine, rng = Coordinator(functions, np.array([150.0, 125.0, 150.0] * 2), rate=100.0), np.random.default_rng(1000)
    for _ in range(40):
        memory = machine.begin(str(rng.choice([*functions, SAFE])), rng.uniform())
        for _ in range(12):
            planned = functions.get(memory.function, functions["rise"]).expected(memory.phase)
            likely = planned if rng.random() < 0.7 else ALL_SETS[rng.integers(8)]
            sure, slips, broken = rng.choice([0.9999, 0.97, 0.5]), rng.random() < 0.03, rng.random() < 0.1
            request = str(rng.choice([*functions])) if rng.random() < 0.5 else None
            posture = functions[request or rng.choice([*functions])].flexion[rng.choice([0, 100, -1])]
            for k in range(rng.integers(5, 40)):
                chances = dict(zip(ALL_SETS, (1.0 - sure) * rng.dirichlet(np.full(8, 0.3)), strict=True))
                chances[likely] += 0.9999 * sure
                near = posture + 0.1 * rng.standard_normal((2, 3))
                events = {"lost": slips and k == 0, "broken": broken}
                machine.decide(memory, chances, near, None if k else request, **events)
                machine.bound(memory, 200.0 * rng.standard_normal(6), 8.0 * rng.standard_normal(6))
    law, calls = compiled(alone(machine), tmp_path), [*steps[machine].values()]
    off = max(check(law, machine, each) for each in calls)
    seen = {(each[5].function, each[5].level) for run in calls for each in run}
    print(f"{sum(map(len, calls))} steps, {len(seen)} functions and levels; torque differs by {off:.1e} of its limit")
    assert len(seen) > 20
    moves = {(a[5].function, b[5].function) for run in calls for a, b in pairwise(run)}
    assert {("stand", "walk"), (SAFE, "stand"), (SAFE, "rise"), ("stairs down", "stand"), ("walk", SAFE)} <= moves


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_decisions_and_torque_along_the_day_of_three_minutes(steps, tmp_path, name):
    """Planted faults on logs of the day; EXOID_FULL_STUDIES for all of it."""
    full = bool(os.environ.get("EXOID_FULL_STUDIES"))
    events = 200 if full else 20
    coordinate(name, seconds=180.0 if full else 30.0, events=events, seed=1000)
    laws, off, count = {}, 0.0, 0
    for machine, runs in steps.items():
        key = tuple((each.duration, each.flexion.tobytes()) for each in machine.functions.values())
        count += sum(map(len, runs.values()))
        law = laws[key] = laws[key] if key in laws else compiled(alone(machine), tmp_path)
        off = max(off, *(check(law, machine, each) for each in runs.values()))
    print(f"{name}: {count} steps of {len(steps)} events, torque differs by {off:.1e} of its limit")
    assert len(steps) == events


class Recorded(CoordinatedLoop):
    """The loop without what C leaves to its caller: made-up readings and a lower friction; it notes each step."""

    def _mend(self, reading):
        flags = np.resize(self._told.frozen, 2 * len(reading.q) + 1)[[*range(len(reading.q)), -1]]
        self._frozen = dict.fromkeys(np.flatnonzero(flags).tolist(), 0.0)
        return reading, bool(self._frozen)

    def _watch(self, *arguments):
        law = self.law
        super()._watch(*arguments)
        self.law = law

    def _lost(self, reading):
        self.row["slips"] = super()._lost(reading) or 0.0 <= reading.time - self.slips < 1e-3
        return self.row["slips"]

    def _follow(self, *arguments):
        target, plan = super()._follow(*arguments)
        turns = [np.append(x, 1.0) for x in self.law.model.turns.values()]
        self.row |= {"q_d": target.q, "v_d": target.v, "a_d": target.a, "pitch_d": target[3:]}
        self.row["tilt_d"] = [0.0 if plan is None else x @ plan for x in turns]
        return target, plan

    def __call__(self, reading):
        asked = self._requests[-1][1] if self._requests and reading.time >= self._requests[-1][0] else None
        self.contacts.closed[:] = [reading.switches["left_foot"].any(), True, -1.0]  # the right one is stuck
        self.row = {name: getattr(reading, name).copy() for name in ("q", "v", "interaction", "push")}
        self.row |= {"pitch": (reading.pitch, reading.pitch_rate), "closed": self.contacts.closed.copy()}
        self.row |= {"wish": 0 if asked is None else 1 + [*FUNCTIONS].index(asked), "broken": 0.0, "lean": 0.0}
        plane = self.law.model.leg.plane
        self.row["force"] = reading.specific_force @ np.array([plane.forward, plane.up]).T
        tau = super().__call__(reading)
        self.rows.append((self.row, tau.copy(), self._told.probability.copy(), self._wrench.copy()))
        return tau


class Switched(ContactFilter):
    """The filter with switches, which the loop does not read."""

    def advance(self, memory, readings, expected=frozenset()):
        flags = zip(self.feet, self.closed, strict=False)
        switches = {link: np.full(len(readings.q), bool(x)) for link, x in flags}
        return super().advance(memory, readings._replace(switches=switches), expected)


@pytest.mark.slow
@pytest.mark.parametrize("event", ["frozen", "slips"])
def test_readings_become_contacts_function_shares_and_torque(tmp_path, event):
    """It begins in the safe stop, stands, and sits down until an encoder freezes, or a foot is said to slip."""
    plant = bleex_machine()
    plant = replace(plant, soles={**plant.soles, plant.root_link: SEAT_SOLE})
    own = loop_of(plant, {})
    told = Switched(*(getattr(own.contacts, field.name) for field in fields(own.contacts)))
    told.__dict__["closed"] = np.zeros(3)
    loop = Recorded(own.law, told, own.coordinator, {0.45: "sit"}, SAFE)
    loop.rows, loop.slips, loop._memory.torque = [], 1.0 if event == "slips" else np.inf, np.zeros(6)
    faults = Faults(frozen={"left_knee": 1.0} if event == "frozen" else {})
    run_of(plant, loop, "sit", 0.3, 1.4, PASSIVE, faults=faults)
    law, memory, off = compiled(loop, tmp_path), None, np.zeros(3)
    names = [*loop.coordinator.functions, SAFE]
    for k, ((row, *expected), decision) in enumerate(zip(loop.rows, loop.decisions, strict=True)):
        inputs = records(law.source, 1, {**row, "solve": ctypes.cast(solve, ctypes.c_void_p).value})
        inputs["reading"] = inputs["target"] = k + 1
        tau, status, memory = law.run(inputs, memory)
        state = np.frombuffer(memory, state_type(law.source))[0]
        assert status[0] == 0
        assert (names[state["function"]], LEVELS[state["level"]]) == (decision.function, decision.level)
        np.testing.assert_allclose(state["share"], [decision.shares.get(x, 0.0) for x in CONTACTS], atol=1e-12)
        found = tau[0] / 150.0, state["probability"], state["wrench"] / loop.law.weight
        scaled = expected[0] / 150.0, expected[1], expected[2] / loop.law.weight
        off = np.maximum(off, [np.abs(x - y).max() for x, y in zip(found, scaled, strict=True)])
    seen = {(each.function, each.level) for each in loop.decisions}
    print(f"{event}: {k + 1} steps; torque over its limit, probability, wrench over the weight: {off}")
    assert {(SAFE, "damping"), (SAFE, "support"), ("stand", "support"), ("sit", "support")} <= seen
    assert loop.decisions[-1].function == SAFE or event == "frozen"
    assert loop.decisions[-1].level == "damping" or event == "slips"
    assert (off < [2e-11, 1e-12, 1e-11]).all()
