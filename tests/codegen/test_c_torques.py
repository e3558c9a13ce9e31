"""What the C computes is what Pinocchio and the estimate compute."""

import numpy as np
import pytest
from compiled import CompiledLeg, made_up, needs_compiler, source_of
from planar_chains import assert_relative, random_chain, random_motion

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.leg import dynamics
from exoid.torques import Stribeck

pytestmark = needs_compiler

EXACT, SINGLE = 1e-12, 3e-6
"""Largest error allowed in double and in float, relative to the largest entry."""

LEGS = {
    **{f"bleex {side}": exoid.load_leg("bleex", side=side, inertias="identified") for side in ("left", "right")},
    **{f"cuhk {side}": exoid.load_leg("cuhk", side=side) for side in ("left", "right")},
    **{
        f"chain {seed}, {'' if cumulative else 'not '}cumulative": random_chain(
            np.random.default_rng(seed), seed % 5 + 1, continuous=True
        ).leg(cumulative=cumulative)
        for seed, cumulative in [(0, True), (1, False), (2, True), (3, True), (3, False), (4, True), (4, False)]
    },
}


@pytest.fixture(params=LEGS, scope="module")
def case(request, tmp_path_factory):
    """An estimate with every term, and its C."""
    estimate = made_up(LEGS[request.param], seed=len(request.param))
    return estimate, CompiledLeg(source_of(estimate), tmp_path_factory.mktemp("leg"))


@pytest.fixture(params=["bleex left", "cuhk right", "chain 4, cumulative"])
def leg(request):
    return LEGS[request.param]


def motion_of(estimate, seed=0):
    return random_motion(np.random.default_rng(seed), len(estimate.joint_names), turns=0.5)


def test_every_function_is_that_of_pinocchio_and_the_estimate(case):
    """The mass matrix has rotors on its diagonal; at rest the parts add up to the whole."""
    estimate, c = case
    q, v, a = motion_of(estimate)
    names, model, still = [f"Ia_{label}" for label in estimate.leg.joint_labels], estimate.leg.model, np.zeros_like(q)
    rotors = np.diag([estimate.value(name) if name in estimate.names else 0.0 for name in names])
    M = c.mass_matrix(q)
    assert np.array_equal(M, np.swapaxes(M, 1, 2))
    parts = np.einsum("kij,kj->ki", M, a) + c("gravity", q) + c("friction", still) + c("stiffness", q)
    for found, expected in (
        (c("inverse_dynamics", q, v, a), estimate.torque(q, v, a)),
        (c("rigid_bodies", q, v, a), dynamics.inverse_dynamics(model, q, v, a)),
        (c("gravity", q), dynamics.inverse_dynamics(model, q, still, still)),
        (M, dynamics.mass_matrix(model, q) + rotors),
        (parts, estimate.torque(q, still, a)),
    ):
        assert_relative(found, expected, EXACT)


SETS = {
    "none": (),
    "sharp friction": (Coulomb(smoothing=0.0), Viscous()),
    "sharp friction with a dead band": (Coulomb(smoothing=0.0, dead_band=0.5),),
    "smooth friction with a dead band": (Coulomb(smoothing=0.3, dead_band=0.5),),
    "an offset and a spring, whose constants are one": (Offset(), Stiffness()),
    "a spring and an offset": (Stiffness(degree=1), Offset()),
    "constant springs": (Stiffness(degree=0),),
    "high powers": (Stiffness(degree=8),),
    "Stribeck's": (Coulomb(), Stribeck()),
    "Stribeck's, sharp with a dead band": (Stribeck(velocity=0.4, smoothing=0.0, dead_band=0.3), Viscous()),
    "some joints only": (Coulomb(joints=("knee",)), Armature(joints=("left_knee",)), Offset(joints=("hip",))),
    "smooth at the hip, sharp at the knee": (Coulomb(joints=("hip",)), Coulomb(joints=("knee",), smoothing=0.0)),
}


@pytest.mark.slow
@pytest.mark.parametrize("terms", SETS.values(), ids=SETS)
def test_every_form_of_every_term_is_the_same_in_c(terms, tmp_path):
    estimate = made_up(exoid.load_leg("cuhk"), terms)
    c = CompiledLeg(source_of(estimate), tmp_path)
    q, v, a = motion_of(estimate)
    v[:8, 0] = 0.0, -0.0, 0.5, 1e-9, 0.49, -0.49, 0.02, 1.0
    v[:8, 1] = 0.5, -0.5, 0.0, -1e-9, 0.51, -0.51, 0.3, -1.0
    assert_relative(c("inverse_dynamics", q, v, a), estimate.torque(q, v, a), EXACT)
