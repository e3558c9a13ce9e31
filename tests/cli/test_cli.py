"""The command line does what the Python API does, and ends in one line when it cannot."""

import json

import numpy as np
import pytest

import exoid
from exoid import Estimate, Recording, Stiffness
from exoid.torques import DEFAULT_TERMS

TRAIN, TEST = "bleex_swing:train", "bleex_swing:test"


def write(path, recording, **renamed):
    """Write a log as CSV under other headers."""
    recording.to_csv(path)
    header, rest = path.read_text(encoding="utf-8").split("\n", 1)
    path.write_text(",".join(renamed.get(name, name) for name in header.split(",")) + "\n" + rest, encoding="utf-8")


def test_identify_prints_and_writes_the_estimate(exoid_, estimate, tmp_path):
    assert exoid_("identify", "bleex", TRAIN, "-o", "leg.json") == (0, f"{estimate}\n", "")
    loaded = Estimate.load(tmp_path / "leg.json")
    assert (loaded.values == estimate.values).all()
    assert (loaded.covariance == estimate.covariance).all()


def test_json_is_all_there_is_on_standard_output_and_equals_the_api(exoid_, estimate):
    run = exoid_("identify", "bleex", TRAIN, "--json")
    expected = json.loads(json.dumps(estimate.to_json()))
    del expected["leg"]["urdf"]
    assert (run.code, run.err) == (0, "")
    assert json.loads(run.out) == expected


@pytest.mark.parametrize(
    ("words", "settings"),
    [
        ("--terms none", {"terms": ()}),
        ("--terms coulomb", {"terms": DEFAULT_TERMS[:1]}),
        ("--terms stiffness,coulomb", {"terms": (Stiffness(), DEFAULT_TERMS[0])}),
        ("--terms coulomb,viscous,armature,offset", {"terms": DEFAULT_TERMS}),
        ("--estimator ols --cutoff 5", {"estimator": "ols", "cutoff": 5.0}),
        (TEST, {}),
    ],
)
def test_options_and_several_logs_are_passed_on(exoid_, data, words, settings):
    found = exoid_("identify", "bleex", TRAIN, *words.split(), "--no-check", "--json").data
    logs = [data.train, data.test] if words == TEST else data.train
    expected = exoid.identify(data.leg, logs, check=False, **settings)
    assert found["values"] == dict(zip(expected.names, expected.values.tolist(), strict=True))


RIGHT_LEG, PLAIN = ("right_hip", "right_knee", "right_ankle"), ("hip", "knee", "ankle")


@pytest.mark.parametrize(
    ("names", "options", "side"),
    [
        (RIGHT_LEG, (), "right"),
        (("left_hip", "left_knee", "left_ankle"), (), "left"),
        (PLAIN, (), "left"),
        (PLAIN, ("--side", "right", "--inertias", "identified"), "right"),
    ],
)
def test_the_side_is_that_of_the_log_or_the_one_that_is_asked_for(exoid_, data, tmp_path, names, options, side):
    write(tmp_path / "log.csv", Recording(data.train.time, data.train.q, tau=data.train.tau, joint_names=names))
    run = exoid_("identify", "bleex", "log.csv", *options, "--no-check", "--json")
    assert run.data["leg"]["joints"] == [f"{side}_{joint}" for joint in PLAIN]


def test_a_log_of_both_sides_must_say_which(exoid_, data, tmp_path):
    both = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle"))
    q, tau = np.hstack([data.train.q] * 2), np.hstack([data.train.tau] * 2)
    write(tmp_path / "log.csv", Recording(data.train.time, q, tau=tau, joint_names=both))
    line = exoid_("identify", "bleex", "log.csv").refusal
    assert "both sides" in line
    assert "--side left" in line
    assert exoid_("identify", "bleex", "log.csv", "--side", "right", "--no-check").code == 0


def test_a_urdf_and_a_log_of_some_of_its_joints(exoid_, data, tmp_path):
    """The joints that move are those in the log, from the base outwards, whatever their order in the file."""
    (tmp_path / "my.urdf").write_bytes((exoid.catalog.urdf_folder() / "bleex.urdf").read_bytes())
    write(tmp_path / "log.csv", data.train.select(("left_knee", "left_hip")))
    logged = exoid_("identify", "my.urdf", "log.csv", "--no-check", "--json").data["leg"]
    assert logged["joints"] == ["left_hip", "left_knee"]
    run = exoid_("identify", "my.urdf", TRAIN, "--joints", "left_hip, left_ankle", "--no-check", "--json")
    assert run.data["leg"]["joints"] == ["left_hip", "left_ankle"]


def test_identify_predicts_logs_that_it_does_not_fit(exoid_, estimate, data):
    predicted = exoid.validate(estimate, data.test)
    assert exoid_("identify", "bleex", TRAIN, "--test", TEST) == (0, f"{estimate}\n\n{predicted}\n", "")
    found = exoid_("identify", "bleex", TRAIN, "--test", TEST, "--test", TRAIN, "--json").data
    assert found["tests"] == [exoid.validate(estimate, each).to_json() for each in (data.test, data.train)]
    assert found["values"] == pytest.approx(dict(zip(estimate.names, estimate.values, strict=True)))


def test_validate_prints_the_validation_or_json(exoid_, data, saved):
    expected = exoid.validate(saved, data.test)
    assert exoid_("validate", "est.json", TEST) == (0, f"{expected}\n", "")
    assert exoid_("validate", "est.json", TEST, "--json").data == expected.to_json()


def test_validate_reads_logs_as_identify_does(exoid_, data, saved, tmp_path):
    degrees = {"q": np.rad2deg(data.test.q), "largest_angle": np.inf}
    log = Recording(data.test.time, tau=data.test.tau, joint_names=data.test.joint_names, **degrees)
    write(tmp_path / "log.csv", log, q_left_hip="angle")
    options = ("--column", "q_left_hip=angle", "--degrees", "--start", "2", "--stop", "12", "--json")
    run = exoid_("validate", "est.json", "log.csv", *options)
    expected = exoid.validate(saved, data.test.between(2.0, 12.0))
    np.testing.assert_allclose(run.data["nrmse"], expected.nrmse, rtol=1e-9)


def test_validate_against_a_constant_torque_prints_json_that_is_json(exoid_, data, saved, tmp_path):
    tau = np.zeros_like(data.test.tau)
    write(tmp_path / "log.csv", Recording(data.test.time, data.test.q, tau=tau, joint_names=data.leg.joint_names))
    run = exoid_("validate", "est.json", "log.csv", "--json")
    assert json.loads(run.out, parse_constant=pytest.fail)["nrmse"] == [None, None, None]
