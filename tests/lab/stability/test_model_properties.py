"""Properties 1 and 2 of document 2 hold for legs, Property 3 does not, and each can be seen to fail."""

from __future__ import annotations

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, exact_estimate
from planar_chains import random_chain

import exoid
from exoid import ExoidError, published
from exoid.control import ControlModel
from exoid.lab.stability import check_properties
from exoid.rig import Plant


@pytest.mark.parametrize("source", [LEG, exact_estimate(), cuhk_plant(), exoid.load_leg("bleex")], ids=repr)
def test_properties_1_and_2_hold_and_property_3_does_not(source):
    found = check_properties(source)
    assert found.symmetric_positive_definite
    assert found.skew_symmetric
    assert not found.bounded
    assert not found.coriolis_bounded


@pytest.mark.parametrize("seed", range(4))
def test_they_hold_for_any_planar_chain(seed):
    found = check_properties(random_chain(np.random.default_rng(seed), seed + 1).leg(), poses=100)
    assert found.symmetric_positive_definite
    assert found.skew_symmetric
    assert found.bounded == (seed == 0), "a single joint has no Coriolis torque; a leg without friction none either"


def test_coriolis_grows_in_proportion_to_speed():
    """The closed form of doc. 2, eqs. (18)-(19): |C| ≤ |S| (2 |θ̇h| + …), linear in θ̇."""
    found = check_properties(LEG)
    np.testing.assert_allclose(found.coriolis / found.coriolis[0], found.speeds / found.speeds[0], rtol=1e-9)
    assert found.coriolis[0] > 0.5


def test_the_smallest_eigenvalue_is_that_of_a_grid_of_poses():
    """M of doc. 2 depends on the knee alone: a grid over it finds the smallest eigenvalue."""
    knee = np.linspace(-np.pi, np.pi, 2001)
    M = LEG.mass_matrix(np.column_stack([np.zeros_like(knee), knee]))
    smallest = np.linalg.eigvalsh(M)[:, 0].min()
    assert check_properties(LEG, poses=2000).smallest_inertia == pytest.approx(smallest, rel=1e-3)


def test_gravity_and_coulomb_friction_are_bounded_but_viscous_friction_is_not():
    plant = cuhk_plant()
    assert not check_properties(plant).friction_bounded
    dry = Plant.build(LEG, {"c0_hip": 1.4, "c0_knee": 0.6})
    found = check_properties(dry)
    assert found.friction_bounded
    np.testing.assert_array_equal(found.friction, 1.4)
    X1, Y1, X2, Y2 = (published.cuhk_parameters()[name] for name in ("X1", "Y1", "X2", "Y2"))
    assert found.gravity <= 9.81 * (np.hypot(X1, Y1) + np.hypot(X2, Y2))


def test_an_impossible_leg_loses_property_1():
    """Table III's kind of numbers: an inertia too small for the moment that hangs on it."""
    values = np.array([published.cuhk_parameters()[name] for name in LEG.parameter_names])
    values[LEG.parameter_names.index("J1")] = 0.2
    found = check_properties(LEG.with_parameters(values))
    assert not found.symmetric_positive_definite
    assert found.smallest_inertia < 0.0
    assert found.skew_symmetric, "which is an identity, whatever the numbers"


def test_a_wrong_coriolis_matrix_loses_property_2(monkeypatch):
    """C with the same torque C θ̇ but its columns mixed is not the one of Property 2."""
    model = ControlModel.of(LEG)
    true = type(LEG).coriolis

    def other(self, q, v, torso=None):
        C, v = true(self, q, v), np.asarray(v)
        return np.einsum("ki,kj->kij", np.einsum("kij,kj->ki", C, v), v) / (v**2).sum(axis=1)[:, None, None]

    monkeypatch.setattr(type(LEG), "coriolis", other)
    found = check_properties(model)
    assert not found.skew_symmetric
    assert found.symmetric_positive_definite


def test_no_poses_are_refused():
    with pytest.raises(ExoidError, match="properties at 0 poses"):
        check_properties(LEG, poses=0)
