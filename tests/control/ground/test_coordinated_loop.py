"""The closed loop without switches: contacts are told, functions coordinated, and the law supports by what is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import steps_on_ground as steps
from coordinated_runs import RATES, SENSORS, loop_of, run_of

from exoid import ExoidError
from exoid.control.functions import FUNCTIONS, SIDES, Body, joint_angles
from exoid.control.ground import SAFE, CoordinatedLoop, Coordinator, GroundState, Rule
from exoid.control.ground.coordinator import RISES
from exoid.experiments import ground
from exoid.experiments.ground.stance import HAND_RAIL
from exoid.rig.ground import HEALTHY, PASSIVE, Faults, GroundMotion, GroundReading, simulate_on_ground
from exoid.rig.ground.plant import BLEEX_SOLES, Block
from exoid.rig.ground.plant import SEAT as SEAT_SOLE


@pytest.fixture(scope="module")
def machine():
    """BLEEX before a chair of 0.45 m."""
    plant = ground.bleex_machine()
    hip = FUNCTIONS["sit"](Body.of(plant.leg, plant.soles)).torso[-1, 0]
    chair = (Block(hip - 0.5, hip + 0.03, 0.45),)
    return replace(plant, soles={**plant.soles, plant.root_link: SEAT_SOLE}, blocks=chair)


def test_it_stands_on_what_is_told_and_keeps_rate_and_limits_of_torque(machine):
    loop = loop_of(machine, {})
    run = run_of(machine, loop, "stand", 0.0, 0.2, HEALTHY)
    assert {(d.function, d.level) for d in loop.decisions} <= {("stand", "support"), ("stand", "frozen")}
    assert all(set(d.shares) == {*SIDES} for d in loop.decisions)
    assert np.abs(run.q - run.q[0]).max() < 0.05
    fastest = 2.0 * loop.coordinator.limit / RISES / RATES.control
    assert (np.abs(np.diff(run.tau, axis=0)) <= fastest + 1e-9).all()


def test_a_wrong_model_of_the_contacts_ends_in_damping_and_the_safe_stop(machine):
    """A filter of a machine that is three times too heavy knows no contact: nothing drives."""
    loop = loop_of(machine, {})
    loop.contacts = replace(loop.contacts, values=3.0 * loop.contacts.values)
    loop.coordinator = replace(loop.coordinator, patience=0.2)
    run = run_of(machine, loop, "stand", 0.0, 0.5, PASSIVE)
    assert (loop.decisions[-1].function, loop.decisions[-1].level) == (SAFE, "damping")
    assert (run.tau[-20:] * run.v[-20:]).sum() <= 0.0
    assert (np.abs(run.tau) <= machine.leg.limits.effort + 1e-9).all()


def test_a_machine_whose_contacts_become_unknown_holds_its_posture_but_no_joint_in_the_air_that_froze(
    machine, monkeypatch
):
    loop = loop_of(machine, {})
    chances = lambda self, reading: self.__dict__.update(_chances={frozenset(SIDES): float(reading.time < 0.0)})  # noqa: E731
    monkeypatch.setattr(CoordinatedLoop, "_tell", chances)
    loop.coordinator = replace(loop.coordinator, patience=0.2)
    run = run_of(machine, loop, "stand", 0.0, 0.7, PASSIVE)
    assert (loop.decisions[-1].function, loop.decisions[-1].level) == (SAFE, "damping")
    assert np.abs(run.q[-1] - run.q[0]).max() < 0.05
    loop._frozen, loop._memory.known = {1: run.q[-1, 1]}, frozenset(("right",))
    reading = GroundReading(2.0, run.q[-1], run.v[-1], 0.0, 0.0, {}, np.zeros(3), np.zeros(3), np.zeros(6))
    torque, (last, _) = loop._hold(reading), loop._held
    assert torque[1] == 0.0 != last[1]
    loop._frozen = {4: run.q[-1, 4]}
    assert loop._hold(reading)[4] == last[4]


def test_filter_and_coordinator_have_one_rate_and_requests_are_of_functions(machine):
    with pytest.raises(ExoidError, match="Hz"):
        loop_of(machine, {}, rate=250.0)
    with pytest.raises(ExoidError, match="jump"):
        loop_of(machine, {0.3: "jump"})


def test_a_foot_that_is_planned_on_the_ground_and_not_felt_is_lowered_until_it_bears(machine):
    """The right foot begins 2 cm above the ground, and the torso leans 0.03 rad: it lands level, and counts as flat."""
    loop, body = loop_of(machine, {}), Body.of(machine.leg, machine.soles)
    stand, time = loop.coordinator.functions["stand"], np.arange(0.0, 1.2, 0.01)
    flexion, torso = stand.flexion[:1].copy(), stand.torso[0] - np.array([0.0, 0.0, 0.03])
    for side, height in enumerate([0.0, 0.02j]):
        flexion[:, side] = body.reach(torso[:1] + 1j * torso[1], torso[2], np.array([height]), 0.0)
    q = np.tile(joint_angles(machine.leg, flexion), (len(time), 1))
    motion = GroundMotion(time, q, np.zeros_like(q), np.tile(torso, (len(time), 1)))
    run = simulate_on_ground(machine, motion, loop, rates=RATES, sensors=SENSORS, spring=HAND_RAIL, seed=4)
    assert {len(force) for command in loop.commands if command for force in command.forces.values()} == {3}  # flat
    right = run.feet["right_foot"]
    assert not right.touching[:20].any()
    assert right.force[-50:, 2].min() > 100.0
    assert set(loop.decisions[-1].shares) == {*SIDES}
    assert np.abs(run.q[-1] - joint_angles(machine.leg, stand.flexion[:1])[0]).max() < 0.05


def test_a_slide_with_hardly_any_force_along_the_ground_does_not_make_it_slippery(machine, monkeypatch):
    """The accelerometer is off by 0.3 m/s²: soles seem to slide by 4 mm, which is noticed, and not yet by 3 cm."""
    loop, call, off = loop_of(machine, {}), CoordinatedLoop.__call__, np.array([0.3, 0.0, 0.0])
    biased = lambda self, reading: call(self, reading._replace(specific_force=reading.specific_force + off))  # noqa: E731
    monkeypatch.setattr(CoordinatedLoop, "__call__", biased)
    run_of(machine, loop, "stand", 0.0, 0.5, HEALTHY)
    assert max(loop._slipped.values()) > 0.004
    assert loop.law.ground_friction == 0.6


@pytest.mark.parametrize("apart", [0.3, 0.05])
def test_soles_that_keep_their_places_tell_a_reading_that_froze(machine, apart):
    """The hip sinks over two toes; only soles that are not side by side tell a pitch."""
    body, t = Body.of(machine.leg, machine.soles), np.arange(0.0, 0.3, 0.01)
    hip, pitch = 0.1 * t + 1j * (0.85 - t**2), 0.2 * np.sin(5.0 * t)
    flexion = np.stack([body.reach(hip, pitch, 0j * t + x, 0.0) for x in (0.5 * apart, -0.5 * apart)], axis=1)
    truth = np.column_stack([joint_angles(machine.leg, flexion), pitch])
    speed, n = np.gradient(truth, t, axis=0), truth.shape[1] - 1
    for frozen in range(n + 1):
        loop = loop_of(machine, {})
        loop.state = GroundState(truth[0, :-1], truth[0, :-1], 0.0, 0.0, dict.fromkeys(BLEEX_SOLES, "toe"))
        for k, (x, v) in enumerate(zip(truth[:-1].copy(), speed.copy(), strict=False)):
            if k > 20:
                x[frozen], v[frozen] = truth[20, frozen], 0.0
            if k > 22:  # soles seemed to slip, and support has ended
                loop.state = loop.state._replace(contacts={})
            loop._told.frozen = (k > 25) & (np.arange(2 * n + 1) == (frozen if frozen < n else 2 * n))
            reading = GroundReading(t[k], x[:-1], v[:-1], x[-1], v[-1], {}, np.zeros(3), np.zeros(3), np.zeros(n))
            mended, blind = loop._mend(reading)
        assert blind == (frozen == n and apart < 0.1)
        if not blind:
            np.testing.assert_allclose([*mended.q, mended.pitch], truth[k], atol=1e-9)
            np.testing.assert_allclose([*mended.v, mended.pitch_rate], speed[k], atol=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["left_knee", "pitch"])
def test_a_reading_that_freezes_while_the_soles_lie_flat_is_made_up_from_them(machine, name):
    loop = loop_of(machine, {0.0: "sit", 0.8: "stand"})
    run = run_of(machine, loop, "sit", 0.0, 1.2, PASSIVE, faults=Faults(frozen={name: 0.7}))
    assert loop._frozen
    last = loop.decisions[-1]
    assert last.function == "sit"
    assert "damping" not in {d.level for d in loop.decisions}
    posture = loop.coordinator.functions["sit"].flexion[[round(200.0 * last.phase)]]
    assert np.abs(run.q[-1] - joint_angles(machine.leg, posture)[0]).max() < 0.05
    moved = run.q[-1, 1] - run.q[run.time < 0.7][-1, 1]
    assert abs(moved) > 0.2


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.8, 0.25])
def test_soles_that_slip_are_noticed_and_the_law_then_uses_less_friction_than_the_ground_has(machine, friction):
    """Seated, the law pushes the feet apart from the seat by more than ground of 0.25 can bear."""
    loop = loop_of(machine, {}, "sit")
    run = run_of(replace(machine, ground_friction=friction), loop, "rise", 0.3, 0.0, PASSIVE)
    stops = np.flatnonzero([d.function == SAFE for d in loop.decisions])
    slips = [np.trapezoid(run.feet[link].slip, run.time) for link in BLEEX_SOLES]
    assert (friction == 0.8) == (len(stops) == 0) == (max(slips) < 1e-3)
    assert loop.law.ground_friction == 0.6 if friction == 0.8 else 0.05 < loop.law.ground_friction < 0.25
    assert max(slips) < 0.02


@pytest.mark.slow
def test_it_climbs_a_stair_without_hands():
    """Two steps: the foot behind turns about its toe, and the other one lands 12 cm higher."""
    size, plant = steps.STAIRS_UP, ground.bleex_machine()
    plant = replace(plant, blocks=(Block(0.5 * size.length, 3.0, size.climb),))
    names = ("first step", "last step", "stand")
    functions = {name: each for name, each in steps.stepping(plant, size).items() if name in names}
    table = [Rule("stand", "request", names[0]), Rule(names[0], "end", names[1]), Rule(names[1], "end", "stand")]
    table.append(Rule(SAFE, "known", "stand"))
    loop, coordinator = loop_of(plant, {}), Coordinator(functions, plant.leg.limits.effort, table, rate=500.0)
    loop = replace(loop, coordinator=coordinator, requests={0.1: names[0]})
    stand, time = functions["stand"], np.arange(-0.3, 6.3, 0.01)
    q = np.tile(joint_angles(plant.leg, stand.flexion[:1]), (len(time), 1))
    motion = GroundMotion(time, q, np.zeros_like(q), np.tile(stand.torso[0], (len(time), 1)))
    run = simulate_on_ground(plant, motion, loop, rates=RATES, sensors=SENSORS, wearer=PASSIVE, seed=3)
    assert (loop.decisions[-1].function, loop.decisions[-1].level) == ("stand", "support")
    assert {d.level for d in loop.decisions} <= {"support", "frozen"}
    moved = run.position[-1] - run.position[0]
    np.testing.assert_allclose(moved[[0, 2]], [size.length, size.climb], atol=0.02)
    assert np.abs(run.q[-1] - q[0]).max() < 0.05
    assert {name for d in loop.decisions for name in d.shares} == {*SIDES}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "start", "end", "wearer"),
    [
        ("sit", "stand", "sit", HEALTHY),
        pytest.param("rise", "sit", "stand", PASSIVE, marks=pytest.mark.nightly),
        pytest.param("rise", "sit", "stand", HEALTHY, marks=pytest.mark.nightly),
        pytest.param("sit", "stand", "sit", PASSIVE, marks=pytest.mark.nightly),
    ],
)
def test_it_rises_and_sits_with_a_hand_on_a_rail(machine, name, start, end, wearer):
    """No contact but the rail is measured; a share that is given belongs to a foot on the ground."""
    loop = loop_of(machine, {0.0: name}, start)
    run = run_of(machine, loop, name, 0.0, 3.0, wearer)
    last = loop.decisions[-1]
    assert (last.function, last.level) == (end, "support")
    posture = joint_angles(machine.leg, loop.coordinator.functions[name].flexion[-1:])[0]
    assert np.abs(run.q[-1] - posture).max() < 0.1
    assert sum(d.level == "damping" for d in loop.decisions) < 50
    for side, foot in zip(SIDES, ("left_foot", "right_foot"), strict=True):
        share = np.array([d.shares.get(side, 0.0) for d in loop.decisions[-len(run.time) :]])
        lost = np.convolve(run.feet[foot].touching, np.ones(30), "full")[: len(share)] == 0.0
        assert not (lost[30:] & (share[30:] > 0.0)).any()
