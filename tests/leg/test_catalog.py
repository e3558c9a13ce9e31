"""The built-in legs by name."""

import pytest

import exoid


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
