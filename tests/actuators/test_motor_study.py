"""Currents alone, and one recording with a weighed payload, give a leg in N·m with its torque constants.

EXOID_FULL_STUDIES=1 runs the study of scripts/study_torque_constants.py in full.
"""

import os

import pytest
from study_torque_constants import percentile, study

FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"
RIGS, SECONDS = (64, 60.0) if FULL else (4, 20.0)


@pytest.mark.nightly
def test_currents_and_one_payload_give_torque_constants_and_the_leg():
    """k_t to 1 %, η to 2 points, X to 1 %, J to 3 % (P95 of 16 rigs), and honest intervals."""
    errors, inside = study(RIGS, SECONDS)
    p95 = {name: percentile(of_one) for name, of_one in errors.items()}
    print({name: round(100.0 * size, 3) for name, size in p95.items()}, f"coverage {inside.mean():.3f}")
    assert max(p95["kt_hip"], p95["kt_knee"]) <= 0.01
    assert max(p95["eta_hip"], p95["eta_knee"]) * 0.85 <= 0.02
    assert max(p95["X1"], p95["X2"]) <= 0.01
    assert max(p95["J1"], p95["J2"], p95["Ia_knee"]) <= 0.03
    assert 0.92 <= inside.mean() <= 0.97 if FULL else inside.mean() > 0.85
