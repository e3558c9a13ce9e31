"""``exoid plan`` plans, writes, draws, assesses and refuses."""

from functools import partial

import numpy as np
import pytest

import exoid
from exoid.experiments import cuhk
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation
from exoid.experiments.excitation.text import precision_to_json

QUICK = ("--duration", "8", "--highest", "0.6", "--starts", "1", "--noise", "0.3")
LEG = exoid.load_leg("cuhk")


@pytest.fixture
def run(exoid_):
    return partial(exoid_, "plan")


def slow_log(path):
    time = np.arange(3001) / 100.0
    motion = cuhk.swing(cuhk.HIP)
    q = np.array([motion.at(t).q[:, 0] for t in time])
    exoid.Recording(time, q, joint_names=LEG.joint_names).to_csv(path)


@pytest.mark.slow
def test_a_plan_is_written_printed_and_equals_the_api(run, tmp_path):
    done = run("cuhk", "-o", "plan.csv", *QUICK, "--velocity", "2,3", "--figures", "drawn", "--json")
    assert "wrote plan.csv" in done.err
    limits = MotionLimits.of(LEG, velocity=(2.0, 3.0))
    plan = plan_excitation(LEG, noise=0.3, duration=8.0, highest=0.6, starts=1, limits=limits)
    data = done.data
    assert data["predicted_std"] == dict(zip(plan.precision.names, plan.precision.std.tolist(), strict=True))
    assert data["condition_number"] == plan.precision.condition_number
    assert data["duration"] == 8.0
    read = exoid.Recording.from_csv(tmp_path / "plan.csv")
    np.testing.assert_array_equal(read.q, plan.recordings[0].q)
    assert {file.name for file in (tmp_path / "drawn").iterdir()} >= {"motion.pdf", "precision.pdf"}


def test_a_log_is_assessed_in_plain_words_and_as_json(run, tmp_path):
    slow_log(tmp_path / "slow.csv")
    printed = run("cuhk", "--assess", "slow.csv", "--noise", "0.3").printed
    assert "cannot be determined" in printed
    assert "add 20 s: " in printed
    data = run("cuhk", "--assess", "slow.csv", "--noise", "0.3", "--json").data
    said = assess(LEG, exoid.Recording.from_csv(tmp_path / "slow.csv"), noise=0.3)
    assert {key: data[key] for key in precision_to_json(said.precision)} == precision_to_json(said.precision)
    assert data["predicted_std"]["Ia_knee"] is None
    assert data["determined"]["Ia_knee"] == "not"
    assert [advice["what"] for advice in data["advice"]] == [advice.what for advice in said.advice]


@pytest.mark.slow
def test_motions_on_each_foot_are_written_and_printed(run, tmp_path):
    quick = ("--terms", "none", "--duration", "16", "--noise", "0.3")
    done = run("bleex", "--stance", "left,right", "-o", "plan.csv", *quick, "--json", "--figures", "drawn")
    assert "wrote plan_left.csv" in done.err
    data = done.data
    assert set(data["margins"]) == {"left", "right"}
    assert min(margin for margins in data["margins"].values() for margin in margins.values()) > 0.0
    assert set(data["determined"].values()) == {"well"}
    contacts = exoid.Recording.from_csv(tmp_path / "plan_right.csv").contacts
    assert contacts["right_foot"].all()
    assert not contacts["left_foot"].any()
    assert (tmp_path / "drawn" / "precision.svg").stat().st_size > 0
