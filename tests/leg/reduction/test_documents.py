"""The documents' own equations, repaired, against the library: they agree to 1e-12."""

from pathlib import Path

import numpy as np
import oracles
import pinocchio as pin
import pytest
from oracles import Link
from planar_chains import assert_relative

import exoid
from exoid.leg.catalog import URDFS, urdf_folder

TOLERANCE = 1e-12

BLEEX_LENGTHS = (0.43, 0.43)
CUHK_LENGTHS = (0.4165, 0.4182)


def links_of(file: Path, side: str, names: tuple[str, ...]) -> list[Link]:
    """Read m, c and I from the URDF, past the library."""
    model = pin.buildModelFromUrdf(str(file))
    inertias = [model.inertias[model.getJointId(f"{side}_{name}")] for name in names]
    return [Link(i.mass, i.lever[0], i.lever[2], i.inertia[1, 1]) for i in inertias]


def motion(n: int, seed: int = 0, samples: int = 200) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (3, samples, n)) * np.array([3.0, 4.0, 15.0])[:, None, None]


@pytest.fixture(
    params=[("cad", "left"), ("cad", "right"), ("identified", "left"), ("identified", "right")], ids="-".join
)
def bleex(request):
    """A BLEEX leg, and its nine parameters by eqs. (1)-(9), which are those of the tables."""
    inertias, side = request.param
    links = links_of(urdf_folder() / URDFS["bleex", inertias], side, ("hip", "knee", "ankle"))
    parameters = oracles.bleex_parameters(*links, *BLEEX_LENGTHS)
    printed = exoid.published.bleex_parameters("cad" if inertias == "cad" else side)
    assert parameters == pytest.approx(printed, abs=1e-13, rel=0)
    return exoid.load_leg("bleex", side=side, inertias=inertias), parameters


@pytest.fixture
def cuhk(side):
    """A CUHK-EXO leg, and its two links."""
    links = links_of(urdf_folder() / URDFS["cuhk", "nominal"], side, ("hip", "knee"))
    return exoid.load_leg("cuhk", side=side), links


def test_bleex_parameters_are_those_of_equations_1_to_9(bleex):
    leg, parameters = bleex
    assert leg.parameter_names == tuple(parameters)
    np.testing.assert_allclose(leg.parameters, list(parameters.values()), rtol=TOLERANCE, atol=1e-15)


def test_bleex_torques_are_those_of_equations_10_to_12_as_repaired(bleex):
    leg, parameters = bleex
    q, v, a = motion(3)
    expected = oracles.bleex_torques(parameters, *BLEEX_LENGTHS, q, v, a)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, expected, TOLERANCE)
    assert_relative(leg.inverse_dynamics(q, v, a), expected, TOLERANCE)


def test_bleex_regressor_is_the_coefficients_of_equations_10_to_12(bleex):
    """Each column on its own: the torque of a leg that has that one parameter."""
    leg, _ = bleex
    q, v, a = motion(3, seed=1)
    W = leg.regressor(q, v, a)
    for column, name in enumerate(leg.parameter_names):
        unit = {other: float(other == name) for other in leg.parameter_names}
        assert_relative(W[:, :, column], oracles.bleex_torques(unit, *BLEEX_LENGTHS, q, v, a), TOLERANCE)


def test_cuhk_parameters_are_those_of_table_1_as_repaired(cuhk):
    leg, links = cuhk
    expected = oracles.cuhk_parameters(*links, *CUHK_LENGTHS)
    assert expected == pytest.approx(exoid.published.cuhk_parameters(), abs=1e-13, rel=0)
    by_name = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    assert by_name == pytest.approx(expected, rel=TOLERANCE)


def test_cuhk_torques_are_those_of_equations_7_and_8_as_repaired(cuhk):
    leg, links = cuhk
    q, v, a = motion(2)
    expected = oracles.cuhk_equations(*links, *CUHK_LENGTHS, q, v, a)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, expected, TOLERANCE)
    assert_relative(leg.inverse_dynamics(q, v, a), expected, TOLERANCE)


def test_cuhk_matrices_are_those_of_equations_14_to_21_as_repaired(cuhk):
    leg, links = cuhk
    q, v, a = motion(2)
    document = oracles.cuhk_matrices(oracles.cuhk_parameters(*links, *CUHK_LENGTHS), CUHK_LENGTHS[0], q, v)
    assert_relative(leg.mass_matrix(q), document.M, TOLERANCE)
    assert_relative(leg.gravity(q), document.G, TOLERANCE)
    assert_relative(leg.inverse_dynamics(q, v, a), document.torques(v, a), TOLERANCE)
