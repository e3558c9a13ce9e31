"""The coordinator follows its table, supports by known contacts only, and bounds the torque."""

import numpy as np
import pytest

from exoid import ExoidError, load_exo
from exoid.control.functions import FUNCTIONS, SEAT, Body
from exoid.control.ground.coordinator import JERKS, RISES, SAFE, TABLE, Coordinator, Rule
from exoid.rig.ground.plant import BLEEX_SOLES

BODY = Body.of(load_exo("bleex", base="floating"), BLEEX_SOLES)
ALL = {name: make(BODY) for name, make in FUNCTIONS.items()}
BOTH, LEFT, SEATED = frozenset(("left", "right")), frozenset(("left",)), frozenset(("left", "right", SEAT))
LIMIT = np.array([150.0, 125.0, 150.0] * 2)


def coordinator(**options):
    return Coordinator(ALL, LIMIT, rate=100.0, **options)


def run(machine, memory, contacts, seconds, flexion=None, request=None, chance=0.999):
    """Decide for some time; the last decision."""
    posture = ALL["stand"].flexion[0] if flexion is None else flexion
    for k in range(round(seconds * machine.rate)):
        decision = machine.decide(
            memory, {contacts: chance, frozenset(): 1.0 - chance}, posture, None if k else request
        )
    return decision


def test_a_request_is_granted_where_the_other_function_begins():
    machine = coordinator()
    memory = machine.begin()
    assert run(machine, memory, BOTH, 0.5).function == "stand"
    assert run(machine, memory, BOTH, 0.1, ALL["sit"].flexion[0] + 0.6, "sit").function == "stand"  # too far
    assert run(machine, memory, BOTH, 0.1, ALL["sit"].flexion[0] + 0.4).function == "sit"
    seated = run(machine, memory, SEATED, 3.0, ALL["sit"].flexion[-1])
    assert (seated.function, seated.phase) == ("sit", 1.0)
    assert set(seated.shares) == {"left", "right", SEAT}
    assert run(machine, memory, SEATED, 0.1, ALL["rise"].flexion[0], "rise").function == "rise"
    assert run(machine, memory, BOTH, 3.0, ALL["rise"].flexion[-1]).function == "stand"


def test_a_request_in_mid_swing_waits_for_both_feet_and_is_dropped_if_they_do_not_come():
    machine = coordinator()
    for then, expected in ((BOTH, "stand"), (LEFT, "walk")):
        memory = machine.begin("walk", 0.2)
        assert run(machine, memory, LEFT, 0.05, request="stand").function == "walk"
        memory.phase = 0.2
        assert run(machine, memory, then, 0.3).function == expected
    memory = machine.begin("walk", 0.2)
    run(machine, memory, LEFT, 0.05, request="stand")
    memory.waiting = machine.patience
    run(machine, memory, LEFT, 0.02)
    assert memory.request is None
    with pytest.raises(ExoidError, match="did you mean 'stand'"):
        run(machine, memory, LEFT, 0.02, request="stnd")


def test_doubt_freezes_the_support_then_damps_then_stops_and_recovers():
    machine = coordinator()
    memory = machine.begin()
    before = run(machine, memory, BOTH, 0.5)
    frozen = run(machine, memory, BOTH, 0.1, chance=0.95)
    assert frozen.level == "frozen"
    assert frozen.shares == before.shares
    assert run(machine, memory, BOTH, 0.2, chance=0.95).level == "damping"
    assert run(machine, memory, BOTH, 1.6, chance=0.95).function == SAFE
    assert run(machine, memory, BOTH, 0.5).function == "stand"


def test_contacts_that_a_function_does_not_expect_lead_to_the_safe_stop():
    machine = coordinator()
    assert run(machine, machine.begin("rise", 0.5), LEFT, 2.0).function == SAFE


def test_a_broken_sensor_stops_what_lifts_a_foot_with_support_and_lets_the_rest_end():
    machine = coordinator()
    for name, end in (("walk", SAFE), ("rise", "stand")):
        memory, posture = machine.begin(name, 0.5), ALL["stand"].flexion[0]
        for _ in range(200):
            decision = machine.decide(memory, {BOTH: 0.999}, posture, broken=True)
        assert (decision.function, decision.level, {*decision.shares}) == (end, "support", BOTH)


def test_a_lost_footing_is_damped_and_the_stop_ends_by_a_request_only():
    machine = coordinator()
    memory = machine.begin("rise", 0.5)
    stopped = machine.decide(memory, {BOTH: 0.999}, ALL["stand"].flexion[0], lost=True)
    assert (stopped.function, stopped.level, stopped.shares) == (SAFE, "damping", {})
    assert run(machine, memory, BOTH, 0.2).level == "damping"
    assert run(machine, memory, BOTH, 1.0)[::2] == (SAFE, "support")
    assert run(machine, memory, BOTH, 0.5, request="stand").function == "stand"


def test_who_sits_down_without_a_chair_stops_on_both_feet_and_rises_when_asked():
    machine, deep = coordinator(), ALL["sit"].flexion[-1]
    memory = machine.begin("sit", 0.8)
    assert run(machine, memory, BOTH, 3.0, deep)[::2] == (SAFE, "support")
    risen = run(machine, memory, BOTH, 0.02, deep, "stand")
    assert risen[:1] == ("rise",)
    assert 0.15 <= risen.phase < 0.2
    assert run(machine, memory, BOTH, 2.5, ALL["stand"].flexion[0])[::2] == ("stand", "support")


@pytest.mark.parametrize("odd", [({BOTH: 1.0, LEFT: 1.0}, 0.0), ({BOTH: np.nan}, 0.0), ({BOTH: 1.0}, np.nan)])
def test_impossible_probabilities_and_missing_angles_are_refused_and_none_is_unknown(odd):
    machine = coordinator()
    with pytest.raises(ExoidError, match="probabilities"):
        machine.decide(machine.begin(), odd[0], ALL["stand"].flexion[0] + odd[1])
    assert machine.decide(machine.begin(), {}, ALL["stand"].flexion[0]).level == "damping"


@pytest.mark.slow
def test_no_leg_that_may_be_in_the_air_bears_load():
    """Random probabilities, requests and postures: what the last state was does not matter."""
    machine, rng = coordinator(), np.random.default_rng(0)
    sets = [frozenset(), LEFT, frozenset(("right",)), BOTH, SEATED]
    for _ in range(200):
        memory = machine.begin(str(rng.choice(list(ALL))))
        for _ in range(60):
            chances = rng.dirichlet(np.full(len(sets) + 1, 0.03))
            request = str(rng.choice(list(ALL))) if rng.random() < 0.1 else None
            posture = ALL["stand"].flexion[0] + 0.2 * rng.standard_normal((2, 3))
            told = dict(zip(sets, chances[:-1].tolist(), strict=True))
            decision = machine.decide(memory, told, posture, request)
            for side in ("left", "right"):
                down = sum(p for contacts, p in told.items() if side in contacts)
                likely = down >= (0.99 if decision.level == "support" else 0.9 * sum(told.values()))
                assert decision.shares.get(side, 0.0) == 0.0 or likely
            torque = machine.bound(memory, 1e3 * rng.standard_normal(6), v := 8.0 * rng.standard_normal(6))
            assert (np.abs(torque) <= LIMIT + 1e-9).all()
            assert (np.abs(torque * v) <= machine.power + 1e-6).all()


def test_the_torque_moves_with_bounded_rate_and_jerk_and_arrives():
    machine = Coordinator(ALL, LIMIT)
    memory, aim, still = machine.begin(), np.array([100.0, -80.0, 20.0] * 2), np.zeros(6)
    torque = np.array([machine.bound(memory, aim, still) for _ in range(200)])
    rate = np.diff(torque, axis=0, prepend=0.0) * machine.rate
    fastest = 2.0 * LIMIT / RISES
    assert (np.abs(rate) <= fastest + 1e-6).all()
    assert (np.abs(np.diff(rate, axis=0)) * machine.rate <= fastest / JERKS + 1e-3).all()
    np.testing.assert_allclose(torque[-1], aim, rtol=0, atol=1e-2)
    assert (np.abs(torque).max(axis=0) <= np.abs(aim) + 0.01 * LIMIT).all()
    assert np.isfinite(machine.bound(memory, missing := np.full(6, np.nan), missing)).all()


WRONG_TABLES = {
    "unknown": (*TABLE, Rule("stand", "request", "fly")),
    "condition": (*TABLE, Rule("stand", "wish", "sit")),
    "no exit": tuple(rule for rule in TABLE if rule.function != "sit"),
    "no way": (*(rule for rule in TABLE if rule.function != "rise"), Rule("rise", "request", "sit")),
    "contacts": (*TABLE, Rule("sit", "end", "stand")),
}


@pytest.mark.parametrize("name", WRONG_TABLES)
def test_a_wrong_table_is_refused(name):
    with pytest.raises(ExoidError):
        coordinator(table=WRONG_TABLES[name])
