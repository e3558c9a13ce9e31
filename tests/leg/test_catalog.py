"""The built-in legs by name."""

import numpy as np
import pytest

import exoid
from exoid import catalog
from exoid.errors import UnreadableInputError


@pytest.mark.parametrize(
    ("name", "segments", "parameters"),
    [
        ("bleex", ("hip", "knee", "ankle"), ("X1", "Y1", "J1", "X2", "Y2", "J2", "X3", "Y3", "J3")),
        ("cuhk", ("hip", "knee"), ("X1", "Y1", "J1", "X2", "Y2", "J2")),
    ],
)
def test_a_leg_has_the_joints_of_its_side_and_the_documents_parameters(name, segments, parameters, side):
    leg = exoid.load_leg(name, side=side)
    assert leg.joint_names == tuple(f"{side}_{segment}" for segment in segments)
    assert leg.joint_labels == segments
    assert leg.parameter_names == parameters
    assert leg.parameter_units == ("kg·m", "kg·m", "kg·m²") * len(segments)


def test_j_is_cumulative_as_each_document_defines_it():
    assert exoid.load_leg("bleex").cumulative
    assert not exoid.load_leg("cuhk").cumulative


def test_cad_inertias_are_the_same_on_both_sides_and_identified_ones_are_not():
    cad, identified = (
        [exoid.load_leg("bleex", side=side, inertias=inertias).parameters for side in ("left", "right")]
        for inertias in ("cad", "identified")
    )
    np.testing.assert_allclose(cad[0], cad[1], rtol=1e-13)
    assert np.abs(identified[0] - identified[1]).max() > 0.05
    np.testing.assert_allclose(identified[0][:3], [3.9819, -0.4083, 2.380], rtol=1e-12)
    np.testing.assert_allclose(identified[1][:3], [4.0474, -0.4990, 2.598], rtol=1e-12)


def test_an_incomplete_installation_says_so(monkeypatch, tmp_path):
    (tmp_path / "exoid").mkdir()
    monkeypatch.setattr(catalog, "__file__", str(tmp_path / "exoid" / "leg" / "catalog.py"))
    with pytest.raises(UnreadableInputError, match="reinstall exoid"):
        exoid.load_leg("bleex")
