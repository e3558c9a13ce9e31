"""A law on the rig with ground: it stands, on slopes too, beside wearers, on a crutch, and with faults of readings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from ground_machines import residual

from exoid import ExoidError
from exoid.control.ground import GroundLoop, stance
from exoid.experiments import ground
from exoid.experiments.ground.stance import HAND_RAIL
from exoid.rig import Rates
from exoid.rig.ground import SPASTIC, Block, Faults, GroundSensors, GroundWearer, simulate_on_ground

pytestmark = pytest.mark.slow

RATES = Rates(control=250.0, log=500.0, step=5e-4)


@pytest.fixture(scope="module")
def truth():
    return ground.bleex_machine()


@pytest.fixture(scope="module")
def reference(truth):
    return ground.stance_motion(truth, 0.6, stance=ground.Stance(squat=0.03, frequency=0.8), seed=3)


def run_of(plant, motion, law=None, **options):
    loop = GroundLoop(law or stance(plant), motion, lean=plant.ground_lean)
    return loop, simulate_on_ground(plant, motion, loop, rates=options.pop("rates", RATES), **options)


def largest_error(loop, run) -> float:
    return float(np.abs(run.q - np.array([loop.target(t).q for t in run.time])).max())


def test_a_law_that_knows_the_machine_follows_squats_with_both_soles_on_the_ground(truth, reference):
    loop, run = run_of(truth, reference, sensors=GroundSensors(angle_noise=3e-5))
    assert largest_error(loop, run) < 0.03
    assert all((foot.points == 2).all() for foot in run.feet.values())
    assert sum(command is None or not command.feasible for command in loop.commands) <= 1  # before any force is felt
    assert not run.interaction.any()
    log = run.recording(seed=1)
    assert log.tau is not None
    assert len(log) == len(run.time)


@pytest.mark.parametrize(("wearer", "largest"), [(SPASTIC, 0.05), (GroundWearer(effort=0.3), 0.25)])
def test_torques_of_a_wearer_act_beside_those_of_the_machine_and_are_known(truth, reference, wearer, largest):
    """The law does not know of the muscles: what they bear moves the machine against its gains."""
    loop, run = run_of(truth, reference, wearer=wearer)
    assert largest_error(loop, run) < largest
    assert np.abs(residual(replace(run, tau=run.tau + run.interaction))).max() < 1e-5
    assert np.abs(run.interaction).max() > 0.3


def test_the_force_of_a_hand_is_read_and_logged(truth, reference):
    """What the law reads of the rail bears its part of the weight, and the log has the wrench on the torso."""
    seen = []

    class Listening(GroundLoop):
        def __call__(self, reading):
            seen.append(reading.push)
            return super().__call__(reading)

    lifted = replace(reference, base=reference.base + np.array([0.0, 0.05, 0.0]))  # the carriage pulls the torso up
    loop = Listening(stance(truth), reference)
    run = simulate_on_ground(truth, lifted, loop, rates=RATES, spring=HAND_RAIL)
    log = run.recording(wrenches=("torso",))
    pulled = np.array(seen)[-len(run.time) :, 1]
    assert pulled.mean() == pytest.approx(run.wrenches["torso"].force[:, 2].mean(), rel=0.1)
    assert pulled.mean() > 20.0
    assert "torso" in log.wrenches


def test_faults_of_readings(truth, reference):
    """Joint and pitch freeze, switches are late, and one is stuck: torques stay within the limits."""
    late = Faults(switch_delay=0.08, frozen={"left_knee": 0.3})
    for faults in (late, Faults(stuck={"left_foot": False}, frozen={"pitch": 0.3})):
        _, run = run_of(truth, reference, faults=faults)
        assert (np.abs(run.tau) <= truth.leg.limits.effort + 1e-9).all()
    with pytest.raises(ExoidError, match="left_elbow"):
        run_of(truth, reference, faults=Faults(frozen={"left_elbow": 0.0}))
    with pytest.raises(ExoidError, match="delay"):
        Faults(switch_delay=-0.1)
    with pytest.raises(ExoidError, match="shares of"):
        simulate_on_ground(truth, reference, GroundLoop(stance(truth), reference, lambda _: {"left": 1.0}), rates=RATES)


def test_feet_slip_on_a_slippery_patch_only(truth):
    bowing = ground.stance_motion(truth, 0.6, stance=ground.Stance(bow=0.2, frequency=1.2), seed=3)
    for friction, slips in ((0.01, True), (0.8, False)):
        # 1 mm high, under both feet
        plant = replace(truth, blocks=(Block(-0.5, 0.5, 1e-3, friction),))
        _, run = run_of(plant, bowing, stance(truth))
        assert (max(foot.slip.max() for foot in run.feet.values()) > 0.02) == slips


def test_without_contact_the_joints_are_braked(truth, reference):
    """All switches read open: the law is not asked, and nothing drives."""
    loop, run = run_of(truth, reference, faults=Faults(stuck=dict.fromkeys(truth.soles, False)))
    assert all(command is None for command in loop.commands)
    assert (run.tau[1:] * run.v[1:]).sum() < 0.0
