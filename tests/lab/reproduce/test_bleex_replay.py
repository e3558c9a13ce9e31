"""Document 1 replayed: its procedure shows its defects, one joint estimate does not have them.

By day notebook 2 runs and asserts the same replay, and ``test_command.py`` a short one.
"""

import numpy as np
import pytest
from PIL import Image

from exoid.lab.reproduce.bleex import identify_bleex

pytestmark = pytest.mark.nightly

STIFFNESS = [f"b{power}_{joint}" for joint in ("hip", "knee", "ankle") for power in (2, 1, 0)]
FRICTION = [f"c0_{joint}" for joint in ("hip", "knee", "ankle")]


@pytest.fixture(params=["left", "right"])
def name(request):
    return request.param


@pytest.fixture
def side(bleex, name):
    return bleex["json"][name]


def error(side, way, name):
    return side[way]["values"][name] - side["truth"][name]


def relative(side, way, name):
    return error(side, way, name) / side["truth"][name]


def test_the_held_ankles_stiction_biases_j3(side):
    assert abs(relative(side, "sequential", "J3")) > 0.15


def test_one_sided_poses_put_friction_into_the_offsets(side):
    for joint in ("knee", "ankle"):
        moved = side["one_sided"]["values"][f"b0_{joint}"] - side["sequential"]["values"][f"b0_{joint}"]
        assert 0.4 * side["truth"][f"c0_{joint}"] < moved < 1.2 * side["truth"][f"c0_{joint}"]


def test_the_friction_band_is_at_most_the_friction(bleex, name, side):
    for band, joint in zip(bleex["band"][name], ("hip", "knee", "ankle"), strict=True):
        assert band < side["truth"][f"c0_{joint}"] + 0.02


def test_second_differences_of_a_coarse_encoder_lose_the_inertia(side):
    assert relative(side, "coarse_encoder", "J1") < -0.4
    assert relative(side, "coarse_encoder", "J2") < -0.4


def test_hip_stiffness_is_not_identifiable_upright(side):
    assert side["upright_condition_number"] > 500.0


@pytest.mark.parametrize(
    ("parameters", "limit"),
    [(("X1", "X2", "X3"), 0.002), (("J1",), 0.005), (("J2",), 0.01), (("J3",), 0.03)],
)
def test_the_joint_estimate_finds_mass_moments_and_inertias(side, parameters, limit):
    for parameter in parameters:
        assert abs(relative(side, "joint", parameter)) <= limit


@pytest.mark.parametrize(
    ("parameters", "limit"),
    [
        (("Y1", "Y2", "Y3"), 0.01),
        (("b1_hip",), 0.10),
        ([name for name in STIFFNESS if "hip" not in name], 0.06),
        (FRICTION, 0.02),
    ],
)
def test_the_joint_estimate_finds_what_may_be_zero(side, parameters, limit):
    for parameter in parameters:
        assert abs(error(side, "joint", parameter)) <= limit


def test_the_tilted_torso_makes_everything_identifiable(side):
    assert side["joint"]["condition_number"] < 50.0


def test_its_torque_is_as_good_as_the_truth_and_much_better_than_cad(name, side):
    nrmse = {way: np.array(errors) for way, errors in side["nrmse"].items()}
    assert (nrmse["joint"] <= [0.03, 0.07, 0.12]).all()
    assert (nrmse["joint"] <= 1.10 * nrmse["truth"]).all()
    assert (nrmse["sequential"] >= nrmse["joint"] * [4.0, 2.0, 1.4]).all()
    if name == "left":
        assert (nrmse["cad"] >= nrmse["joint"] * [15.0, 6.0, 8.0]).all()


def test_every_figure_is_as_wide_as_a_column(bleex):
    assert [path.name[:9] for path in bleex["figures"]] == [f"doc1_fig{k}" for k in range(3, 8)]
    for path in bleex["figures"]:
        with Image.open(path) as image:
            assert image.width == 700
            assert np.asarray(image.convert("L")).std() > 5.0


def test_the_page_has_every_figure_and_number(bleex, check_page):
    check_page(bleex, "document 1 replayed", 5)


def test_the_joint_estimate_alone_is_that_of_the_replay(bleex):
    """``exoid wear`` identifies the left leg without the rest of the replay."""
    alone = identify_bleex()
    assert dict(zip(alone.names, alone.values.tolist(), strict=True)) == bleex["json"]["left"]["joint"]["values"]
