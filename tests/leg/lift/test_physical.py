"""Physical consistency is decided in closed form, and a semidefinite program agrees."""

import numpy as np
import pytest
from semidefinite import mass_range

import exoid
from exoid.leg.lift import check_physical
from exoid.leg.published import bleex_parameters, cuhk
from exoid.leg.published.parameters import BLEEX_SETS

BOUNDS = {"cad": (8.94, 5.05, 1.81), "left": (10.03, 5.22, 1.82), "right": (9.20, 5.18, 1.56)}
"""Without lengths, as docs/legs.md has them [kg]."""


def published(name):
    return np.array(list(bleex_parameters(name).values()))


@pytest.mark.parametrize("name", BLEEX_SETS)
def test_the_published_sets_of_document_1_are_physical_and_bound_the_masses(leg, name):
    """The lightest legs of a semidefinite program are heavier than the bounds of docs/legs.md, which need no length."""
    X, Y, J = published(name).reshape(3, 3).T
    assert check_physical(leg, published(name))
    assert tuple(((X**2 + Y**2) / -np.diff(J, append=0.0)).round(2)) == BOUNDS[name]
    for first, (bound, assumed) in enumerate(zip(BOUNDS[name], (12.05, 7.3, 3.1), strict=True)):
        least, most = mass_range(leg, published(name), first)
        assert bound < least + 0.01 < assumed < (np.inf if most is None else most)


def test_table_iii_of_document_2_is_no_leg():
    leg = exoid.load_leg("cuhk")
    table = cuhk().tables["III"]
    printed = {**table.column("hip"), **table.column("knee")}
    found = check_physical(leg, [printed[name].value for name in leg.parameter_names])
    assert not found
    assert "shank: its centre of mass is on the wrong side of its joint (X2 = -0.602" in str(found)


@pytest.mark.slow
def test_a_semidefinite_program_agrees_on_physical_consistency(leg):
    rng = np.random.default_rng(0)
    verdicts = []
    for _ in range(40):
        values = leg.parameters * (1.0 + 0.5 * rng.standard_normal(9))
        impossible = [reason for reason in check_physical(leg, values).reasons if "wrong side" not in reason]
        least, _ = mass_range(leg, values, 0)
        assert (least is None) == bool(impossible), impossible
        verdicts.append(bool(impossible))
    assert 5 < sum(verdicts) < 35


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("J3", -0.01, "foot: J3 = -0.01 kg·m² is not positive"),
        ("J2", 0.04, "shank: J2 − J3 = "),
        ("J1", 1.2, "thigh: 5.06 kg below it are too much for J1 − J2 = "),
        ("X2", -1.0, "shank: its centre of mass is on the wrong side"),
    ],
)
def test_what_is_impossible_is_named(leg, name, value, reason):
    values = leg.parameters.copy()
    values[leg.parameter_names.index(name)] = value
    found = check_physical(leg, values)
    assert not found
    assert reason in "\n".join(found.reasons)
    assert "the parameters are not physically consistent" in str(found)
