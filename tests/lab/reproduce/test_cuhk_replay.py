"""Document 2 replayed: 0.05 Hz does not excite the inertias, a multisine does."""

import numpy as np
import pytest
from PIL import Image

pytestmark = pytest.mark.slow


@pytest.fixture
def replay(cuhk):
    return cuhk["json"]


def relative(replay, way, name):
    return replay[way]["values"][name] / replay["truth"][name] - 1.0


def test_table_ii_and_its_moving_average_get_j1_wrong_by_more_than_half(replay):
    assert abs(relative(replay, "table_ii", "J1")) > 0.5


@pytest.mark.parametrize(
    ("names", "limit"), [(("X1", "X2"), 0.01), (("J1",), 0.015), (("J2",), 0.03), (("c0_hip", "c0_knee"), 0.08)]
)
def test_the_multisine_finds_what_table_ii_cannot(replay, names, limit):
    for name in names:
        assert abs(relative(replay, "multisine", name)) <= limit


def test_the_multisine_finds_the_knees_rotor(replay):
    assert abs(replay["multisine"]["values"]["Ia_knee"] - replay["truth"]["Ia_knee"]) <= 0.02


def test_the_multisines_torque_is_right_on_an_independent_motion(replay):
    assert max(replay["nrmse"]["multisine"]) <= 0.05
    assert min(replay["nrmse"]["table_ii"]) > 0.5


def test_a_rotor_that_was_left_out_is_noticed(replay):
    assert replay["nrmse"]["no_rotor"][1] > 5.0 * replay["nrmse"]["multisine"][1]


def test_the_documents_validation_motion_does_not_excite_j2_and_another_does(replay):
    assert max(replay["blindness"]["document"]) < 1.3
    assert min(replay["blindness"]["multisine"]) > 20.0


def test_both_figures_are_written(cuhk):
    assert [path.name[:9] for path in cuhk["figures"]] == ["doc2_fig3", "doc2_fig6"]
    for path in cuhk["figures"]:
        with Image.open(path) as image:
            assert image.width == 700
            assert np.asarray(image.convert("L")).std() > 5.0
    assert cuhk["range"][0] > 10.0


def test_the_page_has_every_figure_and_number(cuhk, check_page):
    check_page(cuhk, "document 2 replayed", 2)
