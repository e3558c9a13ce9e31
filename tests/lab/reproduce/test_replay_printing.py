"""Replays and sequential estimates print what they are, not their arrays."""

import numpy as np
import pytest

from exoid.lab.reproduce.sequential.estimate import SequentialEstimate


@pytest.mark.slow
@pytest.mark.parametrize("replay", ["bleex", "cuhk"])
def test_a_replay_represents_itself_in_one_line_without_arrays(replay, request):
    for text in request.getfixturevalue(replay)["repr"]:
        assert "array" not in text
        assert "\n" not in text
        assert len(text) < 500


@pytest.mark.slow
def test_a_replay_of_document_1_names_its_torque_errors(bleex):
    whole, *sides, data = bleex["repr"]
    for name, text in zip(("left", "right"), sides, strict=True):
        errors = " / ".join(f"{error:.3f}" for error in bleex["json"][name]["nrmse"]["joint"])
        assert f"joint {errors}" in text
        assert text in whole
    assert data == "Measurements(192 poses upright, 200 tilted, 15 swings)"


@pytest.mark.slow
def test_a_replay_of_document_2_names_its_torque_errors(cuhk):
    errors = " / ".join(f"{error:.3f}" for error in cuhk["json"]["nrmse"]["multisine"])
    assert f"multisine {errors}" in cuhk["repr"][0]


@pytest.mark.slow
def test_a_comparison_of_laws_names_their_peak_errors(tracking):
    assert "array" not in tracking["repr"][0]
    for name, law in tracking["json"]["laws"].items():
        assert f"{name} {'/'.join(f'{peak:.2f}' for peak in law['peak_deg'])}°" in tracking["repr"][0]


def test_a_sequential_estimate_prints_a_table():
    estimate = SequentialEstimate(("X3", "c0_knee"), np.array([0.25, 0.5]), np.diag([1e-4, 4e-4]))
    assert repr(estimate) == "SequentialEstimate(2 parameters: X3, c0_knee)"
    lines = [line.split() for line in str(estimate).splitlines()]
    assert ["X3", "0.250", "0.010"] in lines
    assert ["c0_knee", "0.500", "0.020"] in lines
