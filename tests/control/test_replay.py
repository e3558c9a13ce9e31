"""Replay of a controller on a log: what it would have commanded, by hand and in a closed loop."""

import json
from dataclasses import replace

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, exact_estimate

from exoid.control import (
    ControlModel,
    Limited,
    gravity_friction_pd,
    gravity_support,
    replay_law,
    sensitivity_amplification,
    simulate_law,
)
from exoid.experiments import healthy_gait
from exoid.signals import Recording

GAIT = healthy_gait(0.8, 4.0)
PD = gravity_friction_pd(exact_estimate(), 60.0, 6.0)


@pytest.fixture(scope="module")
def run():
    """A gait under PD with gravity and friction, exact sensors, logged at the rate of the controller."""
    return simulate_law(cuhk_plant(), PD, GAIT, 4.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    [PD, sensitivity_amplification(exact_estimate(), 3.0, rate=100.0), Limited(PD, 10.0, 100.0)],
    ids=["memoryless", "with memory", "limited"],
)
def test_a_law_that_ran_commands_in_the_replay_what_it_commanded_on_the_rig(law):
    """The log has the torque held until each sample, the replay the one from it on."""
    run = simulate_law(cuhk_plant(), law, GAIT, 2.0) if law is not None else None
    logged = run.recording
    found = replay_law(law, replace(logged, v=run.v, q=run.q), GAIT)
    np.testing.assert_allclose(found.commanded[:-1], run.tau[1:], atol=1e-9)
    np.testing.assert_allclose(found.recorded, logged.tau, atol=1e-12)


def test_gravity_support_commands_the_weight_at_the_angles_of_the_log(run):
    log = replace(run.recording, v=run.v)
    found = replay_law(gravity_support(exact_estimate(), 0.5), log, GAIT, name="half")
    np.testing.assert_allclose(found.commanded, 0.5 * ControlModel.of(exact_estimate()).statics(log.q.T).T, atol=1e-12)
    swapped = replay_law(gravity_support(exact_estimate(), 0.5), log.select(LEG.joint_names[::-1]), GAIT)
    np.testing.assert_array_equal(swapped.commanded, found.commanded)  # joints are found by name
    assert found.law == "half"
    assert "half at 100 Hz" in str(found)


def test_figures_of_a_replay():
    """A hand-made log: constant angle, so constant torque but for the limits."""
    time = np.arange(100) / 100.0
    q = np.tile([0.3, 0.5], (100, 1))
    log = Recording(
        time=time,
        q=q,
        v=np.zeros_like(q),
        tau=np.column_stack([np.full(100, 5.0), np.full(100, np.nan)]),
        joint_names=LEG.joint_names,
    )
    weight = LEG.gravity(q[:1])[0]
    found = replay_law(Limited(gravity_support(LEG), (0.5 * abs(weight[0]), np.inf)), log, GAIT)
    figures = found.figures
    np.testing.assert_allclose(figures["peak_torque"], np.abs(weight) * [0.5, 1.0])
    np.testing.assert_allclose(figures["share_at_limit"], [1.0, 0.0])
    np.testing.assert_allclose(figures["peak_difference"][0], abs(0.5 * weight[0] - 5.0))
    assert np.isnan(figures["rms_recorded"][1])
    np.testing.assert_allclose(figures["peak_rate"], 0.0, atol=1e-12)
    assert json.loads(json.dumps(found.to_json()))["rms_recorded"] == [5.0, None]
