"""Laws for wearers: what the wearer feels on the rig is what the law promises."""

from dataclasses import replace

import numpy as np
import pytest
from controlled_legs import LEG

from exoid.control import (
    PASSIVE,
    ControlModel,
    FrictionCompensation,
    State,
    gravity_support,
    impedance,
    sensitivity_amplification,
    simulate_law,
)
from exoid.experiments import Hold, healthy_gait
from exoid.rig import Payload, Plant, Sensors, Wearer, limb_of, plant_with_payloads

POSE = np.array([0.5, 0.8])
HOLD = Hold(POSE[:, None])
EXACT = Sensors(np.inf)
GAIT = healthy_gait(1.0, 1.2)
LIMB = limb_of(LEG, 1.70, 65.0)
HARDWARE = LEG.with_parameters(LEG.parameters - LIMB.parameters)
FRICTION = {"c0_hip": 1.4, "c0_knee": 0.6, "d_hip": 0.1, "d_knee": 0.2}
ROTORS = {"Ia_hip": 0.1, "Ia_knee": 0.1}
SMOOTH = Plant.build(HARDWARE, ROTORS, end_stops=False)
RUBBING = Plant.build(HARDWARE, {**ROTORS, **FRICTION})
WALKING = Wearer(LIMB, muscle_stiffness=100.0, muscle_damping=5.0, intention=GAIT)
"""A worn CUHK-EXO: hardware as the leg, and a wearer of 1.70 m and 65 kg in it."""


def dynamic_torque(plant: Plant, q, v, a):
    """M a + C v of the bodies and rotors, (N, n)."""
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    return leg.inverse_dynamics(q, v, a) - leg.gravity(q) + a * plant.armature[:, 0]


def accelerations(run):
    """Derivative of the true velocities by central differences, (N, n)."""
    return np.gradient(run.v, run.time, axis=0)


def test_friction_compensation_never_drives():
    """Its power is positive and at most that of the true friction; at rest it is zero."""
    model = ControlModel.of(RUBBING)
    v = np.random.default_rng(0).normal(0.0, 0.5, (2, 2000))
    torque = FrictionCompensation(drives=False).torque(model, State(np.zeros_like(v), v), None)
    true = RUBBING.coulomb * np.abs(v) + RUBBING.viscous * v**2
    assert (torque * v >= 0.0).all()
    assert (torque * v <= true * (1.0 + 1e-12)).all()
    assert np.mean(torque * v) > 0.8 * np.mean(true)
    assert not FrictionCompensation(drives=False).torque(model, State(np.zeros(2), np.zeros(2)), None).any()


@pytest.mark.parametrize(("c0", "d"), [(-0.5, 0.1), (0.5, -0.4), (-0.2, -0.1)])
def test_friction_of_the_wrong_sign_is_not_compensated(c0, d):
    """Table III as printed, or an estimate whose viscous friction is slightly negative."""
    wrong = replace(ControlModel.of(RUBBING), coulomb=np.full(2, c0), viscous=np.full(2, d))
    v = np.linspace(-3.0, 3.0, 61) * np.ones((2, 1))
    torque = PASSIVE.torque(wrong, State(np.zeros_like(v), v), None)
    assert (torque * v >= 0.0).all()
    assert (torque == 0.0)[:, np.abs(v[0]) > 2.0].all() or d > 0.0


@pytest.mark.nightly
@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_the_wearer_carries_the_rest_of_the_weight(share):
    """A wearer who holds still: τ_wearer = (1 − share) G(q) of the leg."""
    still = Wearer(LIMB, muscle_stiffness=400.0, muscle_damping=20.0, intention=HOLD)
    run = simulate_law(SMOOTH, gravity_support(SMOOTH, share), HOLD, 6.0, wearer=still)
    weight = SMOOTH.leg.gravity(run.q[-1])[0]
    assert np.abs(weight).min() > 0.5
    np.testing.assert_allclose(run.interaction[-1], (1.0 - share) * weight, atol=0.01)


@pytest.mark.slow
def test_the_stiffness_of_the_closed_loop_is_the_one_asked_for():
    """A weight that the law does not know bends the loop by exactly K⁻¹ ΔG; on a leg without friction."""
    load, stiffness = Payload("knee", 2.0, (0.0, 0.0, -0.3)), np.array([80.0, 50.0])
    loaded = plant_with_payloads(SMOOTH, (load,))
    run = simulate_law(loaded, impedance(SMOOTH, stiffness, 15.0, rate=500.0), HOLD, 8.0, sensors=EXACT)
    known, true = SMOOTH.leg, SMOOTH.leg.with_parameters(loaded.parameters[:, 0])
    extra = (true.gravity(run.q[-1]) - known.gravity(run.q[-1]))[0]
    assert np.abs(run.v[-1]).max() < 1e-6
    assert np.abs(extra).min() > 1.0
    np.testing.assert_allclose(stiffness * (POSE - run.q[-1]), extra, rtol=1e-4)


@pytest.mark.slow
def test_the_wearer_feels_a_spring_and_a_damper_about_the_target():
    """τ_wearer = −(M ë + D ė + K e), with sampling at 1 kHz, over a gait against a fixed target."""
    law = impedance(SMOOTH, 30.0, 4.0, rate=1000.0)
    run = simulate_law(SMOOTH, law, HOLD, 2.4, wearer=WALKING, sensors=EXACT, settle=0.2)
    error, late = POSE - run.q, run.time > 0.2
    M = SMOOTH.leg.mass_matrix(run.q) + np.diag(SMOOTH.armature[:, 0])
    felt = np.einsum("kij,kj->ki", M, accelerations(run)) + 4.0 * run.v - 30.0 * error
    difference = np.sqrt(np.mean((run.interaction - felt)[late] ** 2, axis=0))
    assert (difference < 0.02 * run.rms_interaction).all()


def felt_share(amplification, bandwidth, rate=1000.0):
    """Share of the leg's dynamic torque that a walking wearer feels: regression, and what it leaves."""
    law = sensitivity_amplification(SMOOTH, amplification, bandwidth=bandwidth, rate=rate)
    run = simulate_law(SMOOTH, law, GAIT, 1.8, wearer=WALKING, sensors=EXACT)
    late = run.time > 0.6
    whole = dynamic_torque(SMOOTH, run.q, run.v, accelerations(run))[late]
    felt = run.interaction[late]
    share = (felt * whole).sum() / (whole * whole).sum()
    return share, np.sqrt(np.mean((felt - whole / amplification) ** 2) / np.mean(whole**2))


@pytest.mark.nightly
@pytest.mark.parametrize("amplification", [2.0, pytest.param(10.0, marks=pytest.mark.slow)])
def test_the_wearer_feels_one_alphath_of_the_inertia(amplification):
    """The difference shrinks as the filter passes more: in proportion to its delay."""
    errors = []
    for bandwidth in (10.0, 40.0, 160.0):
        share, error = felt_share(amplification, bandwidth)
        errors.append(error)
    assert share == pytest.approx(1.0 / amplification, abs=0.01)
    assert errors[2] < 0.03
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.5 * errors[1]


def test_a_model_that_is_too_heavy_makes_the_loop_unstable():
    """Rotors eight times too large in the model: (1 − 1/α) M̂ exceeds M for α = 1.5, not for α = 1.2."""
    heavy = Plant.build(SMOOTH.leg, {"Ia_hip": 0.8, "Ia_knee": 0.8})
    ratio = np.linalg.solve(*(ControlModel.of(plant).mass_matrix(POSE) for plant in (SMOOTH, heavy)))
    largest = np.linalg.eigvals(ratio).real.max()
    assert largest * (1.0 - 1.0 / 1.2) < 1.0 < largest * (1.0 - 1.0 / 1.5)
    laws = [sensitivity_amplification(heavy, alpha, bandwidth=60.0) for alpha in (1.2, 1.5)]
    calm, wild = (simulate_law(SMOOTH, law, GAIT, 0.4, wearer=WALKING) for law in laws)
    assert wild.torque_variation.min() > 50.0 * calm.torque_variation.max()


def test_the_law_receives_what_the_cuffs_measure():
    class Listen:
        rate = 100.0

        def __init__(self):
            self.heard = []

        def torque(self, state, target):
            self.heard.append(state.interaction)
            return np.zeros_like(state.q)

    law = Listen()
    run = simulate_law(RUBBING, law, GAIT, 1.0, wearer=WALKING)
    np.testing.assert_array_equal(law.heard, run.interaction)
    simulate_law(RUBBING, unworn := Listen(), GAIT, 0.1)
    assert unworn.heard[0] is None
