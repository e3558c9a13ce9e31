"""Several logs with parameters of their own, on the command line."""

import json

import numpy as np
import pytest

import exoid
from exoid import Estimate, Recording

IDENTIFY = ("identify", "bleex", "--no-check")
ZERO = (2.0, -1.0, 0.5)
"""By which torque sensors differ between the two logs [N·m]."""


@pytest.fixture
def logs(tmp_path, data):
    """Two logs of one leg; before the second its torque sensors were zeroed anew."""
    data.train.to_csv(tmp_path / "monday.csv")
    second = data.test
    arrays = {"time": second.time, "q": second.q, "v": second.v, "a": second.a, "tau": np.add(second.tau, ZERO)}
    Recording(**arrays, joint_names=second.joint_names).to_csv(tmp_path / "tuesday.csv")
    return ["monday.csv", "tuesday.csv"]


def test_each_log_has_its_own_and_the_table_says_so(exoid_, logs):
    code, out, err = exoid_(*IDENTIFY, *logs, "--own", "offset", "-o", "leg.json")
    together = exoid.identify(
        exoid.load_leg("bleex"), {log[:-4]: Recording.from_csv(log) for log in logs}, own="offset", check=False
    )
    assert (code, out, err) == (0, f"{together}\n", "")
    for log in ("monday", "tuesday"):
        saved = Estimate.load(f"leg-{log}.json")
        np.testing.assert_array_equal(saved.values, together[log].values)
        np.testing.assert_array_equal(saved.covariance, together[log].covariance)
    np.testing.assert_allclose(together.compare("monday", "tuesday").difference, ZERO, atol=0.1)


def test_json_equals_the_api(exoid_, logs):
    code, out, err = exoid_(
        "identify", "bleex", "--no-check", *logs, "--own", "offset,c0_hip", "--terms", "coulomb,offset", "--json"
    )
    together = exoid.identify(
        exoid.load_leg("bleex"),
        {log[:-4]: Recording.from_csv(log) for log in logs},
        (exoid.torques.DEFAULT_TERMS[0], exoid.Offset()),
        own=("offset", "c0_hip"),
        check=False,
    )
    expected = json.loads(json.dumps(together.to_json(), allow_nan=False))
    for estimate in expected["groups"].values():
        del estimate["leg"]["urdf"]
    assert (code, err) == (0, "")
    assert json.loads(out) == expected
