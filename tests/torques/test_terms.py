"""What acts on a joint besides rigid bodies: columns, units, signs, and the joints acted on."""

import numpy as np
import pytest

from exoid import Armature, Coulomb, ExoidError, Offset, Stiffness, Viscous
from exoid.torques import DEFAULT_TERMS, CoordinateTerm, JointMotion, Term
from exoid.torques.catalog import TERMS


def columns(term: Term, q: object = 0.0, v: object = 0.0, a: object = 0.0) -> np.ndarray:
    """The columns of one joint, (number of symbols, N)."""
    q, v, a = (np.ascontiguousarray(x, dtype=float) for x in np.broadcast_arrays(np.atleast_1d(q), v, a))
    out = np.zeros((len(term.symbols), len(q)))
    term.fill(JointMotion(q, v, a, np.zeros_like(q)), out)
    return out


@pytest.mark.parametrize(
    ("term", "symbols", "units"),
    [
        (Coulomb(), ("c0",), ("N·m",)),
        (Viscous(), ("d",), ("N·m·s/rad",)),
        (Armature(), ("Ia",), ("kg·m²",)),
        (Offset(), ("offset",), ("N·m",)),
        (Stiffness(), ("b2", "b1", "b0"), ("N·m/rad²", "N·m/rad", "N·m")),
        (Stiffness(degree=1), ("b1", "b0"), ("N·m/rad", "N·m")),
        (Stiffness(degree=0), ("b0",), ("N·m",)),
        (Stiffness(degree=3), ("b3", "b2", "b1", "b0"), ("N·m/rad³", "N·m/rad²", "N·m/rad", "N·m")),
    ],
)
def test_each_term_names_its_parameters_and_their_units(term, symbols, units):
    assert term.symbols == symbols
    assert term.units == units
    assert columns(term).shape == (len(symbols), 1)


def test_columns_are_those_of_the_formulas():
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-2, 2, (3, 50))
    np.testing.assert_array_equal(columns(Viscous(), q, v, a), [v])
    np.testing.assert_array_equal(columns(Armature(), q, v, a), [a])
    np.testing.assert_array_equal(columns(Offset(), q, v, a), [np.ones(50)])
    np.testing.assert_allclose(columns(Stiffness(), q, v, a), [q**2, q, np.ones(50)], rtol=1e-15)
    np.testing.assert_allclose(columns(Stiffness(degree=5), q, v, a), [q**k for k in range(5, -1, -1)], rtol=1e-14)
    np.testing.assert_array_equal(columns(Coulomb(smoothing=0.0), q, v, a), [np.sign(v)])
    np.testing.assert_allclose(columns(Coulomb(smoothing=0.3), q, v, a), [np.tanh(v / 0.3)], rtol=1e-15)


def test_a_positive_stiffness_holds_against_the_actuator():
    """τ = b1 q: away from zero the actuator must push outwards, as the spring pulls back."""
    q = np.linspace(-1, 1, 11)
    torque = np.array([0.0, 2.0, 0.0]) @ columns(Stiffness(), q=q)
    np.testing.assert_allclose(torque, 2.0 * q, rtol=1e-15)
    work = np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(q)[:, None].T)
    assert work == pytest.approx(0.0, abs=1e-12)  # a spring gives back what it took


def test_the_work_on_a_rotor_is_its_kinetic_energy():
    t = np.linspace(0.0, 1.0, 20001)
    v, a = 3.0 * np.sin(2 * t), 6.0 * np.cos(2 * t)
    power = 0.8 * columns(Armature(), v=v, a=a)[0] * v
    assert np.trapezoid(power, t) == pytest.approx(0.5 * 0.8 * v[-1] ** 2, rel=1e-7)


def test_samples_within_the_dead_band_are_unusable_and_their_column_is_zero():
    v = np.array([-0.3, -0.1, -0.05, 0.0, 0.05, 0.1, 0.3])
    term = Coulomb(smoothing=0.0, dead_band=0.1)
    np.testing.assert_array_equal(term.usable(v), [True, False, False, False, False, False, True])
    np.testing.assert_array_equal(columns(term, v=v), [[-1, 0, 0, 0, 0, 0, 1]])


def test_every_term_has_a_name_and_the_defaults_are_among_them():
    for name, kind in TERMS.classes.items():
        if issubclass(kind, CoordinateTerm):  # has no joints by default
            with pytest.raises(ExoidError, match=r"cannot be made without settings .*ratios"):
                TERMS.default(name)
            continue
        assert TERMS.default(name) == kind()
        assert TERMS.to_json(kind())["term"] == name
    assert {type(term) for term in DEFAULT_TERMS} <= set(TERMS.classes.values())
