"""``exoid select`` chooses the friction of each joint, and identifies with it."""

import pytest

import exoid
from exoid import Estimate


@pytest.mark.slow
def test_the_choice_is_identified_and_written(exoid_, tmp_path):
    """On a part of a log."""
    part = ("--folds", "3", "--stop", "8", "--known", "Y2=0.0578", "-o", "est.json", "--json")
    data = exoid_("select", "bleex_swing", "bleex_swing:train", *part).data
    estimate = Estimate.load(tmp_path / "est.json")
    assert data["joint_names"] == list(estimate.joint_names)
    assert estimate.value("Y2") == data["known"]["Y2"] == 0.0578
    assert (exoid.validate(estimate, exoid.datasets.bleex_swing().test).nrmse < 0.2).all()
