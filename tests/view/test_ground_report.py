"""Report of a leg that stands: forces of the ground on its feet."""

from dataclasses import replace

import numpy as np
import pytest
from standing import GRAVITY, session

import exoid
from exoid import Viscous
from exoid.estimate.ground_prediction import GroundForce
from exoid.tools.tables import DataTable
from exoid.view.report.ground import _centre_half, ground_blocks
from exoid.view.report.page import Picture


@pytest.fixture(scope="module")
def logs(exo):
    return session(exo, seconds=12.0, noise=0.4, encoder=1e-4)


@pytest.fixture(scope="module")
def estimate(exo, logs):
    return exoid.identify(exo, [log.recording for log in logs], terms=(Viscous(),))


@pytest.mark.nightly
def test_forces_of_both_feet_add_up_to_the_weight_and_agree_with_plates(exo, estimate, logs):
    both = logs[0]
    plates = replace(both.recording, wrenches=both.wrenches)
    _, table, *pictures = ground_blocks(estimate, [plates])
    assert isinstance(table, DataTable)
    assert [row[1] for row in table.rows] == ["left_foot", "right_foot"]
    assert sum(float(row[3]) for row in table.rows) == pytest.approx(GRAVITY * exo.parameters[0], rel=0.01)
    assert all(float(row[5]) < 5.0 for row in table.rows)
    assert all(isinstance(picture, Picture) for picture in pictures)
    # the log is shorter than what is drawn of long ones; near its ends, 0.2 s, no force is predicted
    assert pictures[0].caption.endswith(", 12 s from its first rest")
    assert len(pictures) == 2


def test_the_band_of_the_centre_of_pressure_is_that_of_its_parts():
    rng = np.random.default_rng(0)
    force, moment = np.tile((20.0, 0.0, 500.0), (20_000, 1)), np.tile((0.0, -15.0, 0.0), (20_000, 1))
    sizes = np.array([2.0, 0.1, 4.0]), np.array([0.1, 0.5, 0.1])
    bands = [np.tile(size, (20_000, 1)) for size in sizes]
    exact = GroundForce(np.arange(20_000.0), force, moment, *bands)
    noisy = GroundForce(
        exact.time, *(x + s * rng.standard_normal(x.shape) for x, s in zip((force, moment), sizes, strict=True)), *bands
    )
    spread = (noisy.center_of_pressure(-0.1) - exact.center_of_pressure(-0.1))[:, 0].std()
    assert _centre_half(exact, -0.1)[0] == pytest.approx(spread, rel=0.05)
