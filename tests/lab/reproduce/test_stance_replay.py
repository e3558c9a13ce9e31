"""``exoid reproduce stance``: what swing, stance with force plates and stance without them tell, in a short study."""

import numpy as np
import pytest

from exoid import reproduce
from exoid.lab.reproduce.stance import load_leg, swinging_leg, true_values
from exoid.lab.reproduce.stance_logs import run_stance

pytest.importorskip("mujoco")

SHORT = reproduce.StanceExtent(stance=8.0, swing=8.0, unseen=4.0, walking=16.0)


TINY = reproduce.StanceExtent(3.0, 3.0, 3.0, 3.0)


@pytest.fixture(scope="module")
def runs():
    return run_stance(3, TINY)


@pytest.fixture(scope="module")
def replay():
    return reproduce.reproduce_stance(0, extent=SHORT)


@pytest.mark.nightly
def test_stance_tells_the_torso_and_swing_does_not(replay):
    swing, plates, none = (replay.estimates[way] for way in ("swing", "plates", "no plates"))
    assert not {"M", "X0", "Y0", "J0"} & set(swing.names)
    assert "M, X0, Y0, J0 left no trace" in replay.refused
    assert np.isnan(replay.largest("swing", "M"))
    for estimate in (plates, none):
        assert {"M", "X0", "Y0", "J0"} < set(estimate.names)
    assert replay.largest("plates", "M") < 0.002
    assert replay.largest("no plates", "M") < 0.005
    assert replay.largest("no plates", "X") < 0.02
    assert replay.largest("no plates", "J") < 0.04
    assert all(replay.coverage(way) > 0.75 for way in replay.estimates)


@pytest.mark.nightly
def test_ground_force_follows_from_torques_on_other_motions(replay):
    assert [(each.motion, each.link) for each in replay.forces] == [
        ("unseen squats", "left_foot"),
        ("unseen squats", "right_foot"),
        ("unseen left", "left_foot"),
    ]
    for each in replay.forces:
        assert each.relative < 0.005
        assert each.pressure < 0.005
        assert each.inside > 0.75
        assert np.ptp(each.measured) > 10.0 * each.force


@pytest.mark.nightly
def test_wrong_labels_move_nothing_and_are_counted(replay):
    assert replay.wrong.moved < 1.0
    assert 0.03 < replay.wrong.share < 0.2


@pytest.mark.nightly
def test_a_fixed_torso_is_called_wrong(replay):
    assert any(finding.severity == "error" for finding in replay.walk.fixed)
    assert replay.walk.bias_error < 0.02


@pytest.mark.nightly
def test_the_rotor_of_a_held_hip_is_in_j1(replay):
    truth = replay.truth
    assert replay.true_value("swing", "J1_left") == truth["J1_left"] + truth["Ia_left_hip"]
    assert replay.true_value("plates", "J1_left") == truth["J1_left"]
    assert set(replay.estimates["plates"].names) == set(replay.truth)


@pytest.mark.nightly
def test_the_mask_of_a_swinging_leg_is_off_the_ground(runs):
    log = runs.log("walking")
    leg = load_leg("bleex", side="right")
    one = swinging_leg(log, leg, "right")
    assert one.joint_names == leg.joint_names
    assert np.array_equal(one.q, log.q[:, 3:])
    assert not (one.mask & log.contacts["right_foot"]).any()
    assert not one.contacts


@pytest.mark.slow
def test_the_truth_is_that_of_the_rig(runs):
    truth, leg = true_values(runs.plant), runs.plant.leg
    assert [truth[name] for name in leg.parameter_names] == leg.parameters.tolist()
    assert truth["M"] == pytest.approx(sum(body.mass for body in leg.model.inertias))
    assert (truth["c0_left_hip"], truth["d_right_knee"], truth["Ia_left_ankle"]) == (2.0, 0.2, 0.03)


@pytest.mark.slow
def test_wrong_labels_change_nothing_but_the_contacts(runs):
    right, wrong = runs.log("squats"), runs.log("squats", wrong=0.05)
    assert np.array_equal(right.q, wrong.q)
    assert np.array_equal(right.base.columns, wrong.base.columns)
    assert right.contacts["left_foot"].all()
    assert np.mean(wrong.contacts["left_foot"]) == pytest.approx(0.95, abs=0.002)
    assert set(runs.log("squats", plates=True).wrenches) == {"left_foot", "right_foot"}


@pytest.mark.slow
def test_the_bias_of_the_imu_is_that_of_all_logs(runs):
    for motion in ("squats", "walking"):
        run, log = runs.runs[motion], runs.log(motion)
        exact = run.recording(None, np.random.default_rng([3, list(runs.runs).index(motion)])).base
        np.testing.assert_allclose((log.base.columns - exact.columns).mean(axis=0), runs.bias, atol=1e-2)
