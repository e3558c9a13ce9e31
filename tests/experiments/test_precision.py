"""The predicted precision is that of an identification, and logs are assessed by their motion."""

import os

import numpy as np
import pytest
from unchecked import identify

import exoid
from exoid.experiments import Bench, Harmonics, cuhk
from exoid.experiments.bench import run_motion
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation
from exoid.experiments.excitation.precision import information_of
from exoid.experiments.excitation.scales import Scales, TorqueNoise
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors
from exoid.signals import FiniteDifference, MovingAverage, ZeroPhase
from exoid.torques import DEFAULT_TERMS, TorqueModel

pytestmark = pytest.mark.slow

LEG = exoid.load_leg("cuhk")
MODEL = TorqueModel(LEG, DEFAULT_TERMS)
SMOOTH = TorqueModel(
    LEG, (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), *DEFAULT_TERMS[1:])
)  # friction at reversals is fitted, too
SCALES = Scales.of(MODEL, MotionLimits.of(LEG))
STD = (0.3, 0.2)
NOISE = TorqueNoise(STD)
TRUTH = np.concatenate([LEG.parameters, [1.4, 0.6, 0.3, 0.2, 0.1, 0.5, -0.4]])
FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"


def log(motion, seconds=60.0, rate=100.0, noise=None, **options):
    """What a log of a motion followed perfectly looks like."""
    time = np.arange(round(seconds * rate) + 1) / rate
    states = [motion.at(t) for t in time]
    q, v, a = (np.array([state[k][:, 0] for state in states]) for k in range(3))
    tau = MODEL.regressor(q, v, a) @ TRUTH
    if noise is not None:
        tau = tau + noise.standard_normal(tau.shape) * STD
    return exoid.Recording(time, q, v, a, tau, joint_names=LEG.joint_names, **options)


@pytest.fixture(scope="module")
def multisine():
    return cuhk.multisine(LEG, np.random.default_rng(0), draws=20)


@pytest.mark.parametrize("preparation", [FiniteDifference(), ZeroPhase(8.0), ZeroPhase(3.0)])
def test_predicted_covariance_is_that_of_identification(multisine, preparation):
    """Standard deviations and correlations, for noiseless motion with white torque noise.

    With ``noise="white"``, identification takes filtered noise as flat up to the cut-off. What reversals leave of the
    columns is partly where the filter has less of it, so these standard deviations are 2 to 8 % too large. One
    recording gives the variance of the noise to some percent: standard deviations are averaged.
    """
    recordings = [log(multisine, noise=np.random.default_rng(seed)) for seed in (1, 2, 3, 4)]
    estimate, *others = (identify(LEG, each, preparation=preparation, noise="white") for each in recordings)
    predicted = information_of(MODEL, recordings[:1], NOISE, preparation).precision(MODEL, SCALES)
    np.testing.assert_allclose(np.mean([each.std for each in (estimate, *others)], axis=0), predicted.std, rtol=0.08)
    D = 1.0 / predicted.std
    np.testing.assert_allclose(estimate.correlation, D[:, None] * predicted.covariance * D, atol=0.08)
    assert estimate.condition_number == pytest.approx(predicted.condition_number, rel=0.05)


def test_predicted_covariance_is_exact_for_unfiltered_rows(multisine):
    """(Σ_j W_jᵀ W_j / σ_j²)⁻¹, from the rows themselves."""
    recording = log(multisine, 20.0)
    W = MODEL.regressor(recording.q, recording.v, recording.a)[1:-1]
    information = sum(W[:, j].T @ W[:, j] / std**2 for j, std in enumerate(STD))
    predicted = information_of(MODEL, [recording], NOISE, FiniteDifference()).precision(MODEL, SCALES)
    np.testing.assert_allclose(predicted.covariance, np.linalg.inv(information), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("preparation", [ZeroPhase(4.0), MovingAverage(0.3)])
def test_noise_behind_a_filter_scatters_estimates_as_predicted(multisine, preparation):
    """Least squares on filtered rows, many times over; the moving average is no symmetric filter."""
    recording = log(multisine, 20.0)
    predicted = information_of(SMOOTH, [recording], NOISE, preparation).precision(SMOOTH, SCALES)
    q, v, a, valid = preparation.kinematics(recording)
    assert SMOOTH.reversing(v) is None
    W = SMOOTH.regressor(q, v, a)
    W = (W if preparation.parallel(100.0) is None else preparation.filter(W, 100.0))[valid]
    rng, weight = np.random.default_rng(2), 1.0 / np.array(STD)
    noise = preparation.filter(rng.standard_normal((len(recording), 2, 400)) * np.array(STD)[:, None], 100.0)[valid]
    rows = (W * weight[:, None]).reshape(-1, W.shape[2])
    errors = np.linalg.lstsq(rows, (noise * weight[:, None]).reshape(len(rows), -1))[0]
    np.testing.assert_allclose(errors.std(axis=1), predicted.std, rtol=0.15)


def test_narrow_band_noise_counts_by_its_spectral_density(multisine):
    """Doubling the rate reduces the standard deviation under white noise, but not under noise up to 20 Hz."""
    slow, fast = log(multisine, 20.0, 100.0), log(multisine, 20.0, 200.0)
    for bandwidth, gain in ((np.inf, np.sqrt(2.0)), (20.0, 1.0)):
        noise = TorqueNoise(STD, bandwidth)
        one, two = (information_of(SMOOTH, [x], noise).precision(SMOOTH, SCALES).std for x in (slow, fast))
        np.testing.assert_allclose(one / two, gain, rtol=0.02)


def test_long_logs_are_judged_block_by_block(multisine, monkeypatch):
    recording = log(multisine, 60.0)
    whole = information_of(MODEL, [recording], NOISE).precision(MODEL, SCALES).std
    monkeypatch.setattr("exoid.experiments.excitation.precision.BLOCK", 2000)
    np.testing.assert_allclose(information_of(MODEL, [recording], NOISE).precision(MODEL, SCALES).std, whole, rtol=0.1)


def test_a_recording_in_which_one_joint_moves_is_called_poor_for_the_other():
    """The knee's inertia, friction and rotor leave no trace when it is held."""
    motion = Harmonics(np.full((2, 1), 0.5), np.array([[[0.4], [0.0]]]), np.full((1, 1, 1), 4.0), np.zeros((1, 1, 1)))
    said = assess(LEG, log(motion, 30.0), noise=STD)
    identifiability = dict(zip(said.precision.names, said.precision.identifiability, strict=True))
    for name in ("c0_knee", "d_knee", "Ia_knee"):
        assert identifiability[name] == "not"
    assert identifiability["c0_hip"] == identifiability["d_hip"] == "well"
    assert said.precision.condition_number == np.inf
    assert "left_knee" in " ".join(advice.what for advice in said.advice if "c0_knee" in advice.parameters)
    assert "cannot be determined" in str(said)
    for advice in said.advice:
        assert (np.array(advice.after) < np.array(advice.before)).all()


def test_the_slow_motions_of_document_2_do_not_determine_inertia():
    """Table II at 0.05 Hz: gravity is well known afterwards, inertia and the rotor are not."""
    swings = [log(cuhk.swing(joint), 20.0) for joint in (cuhk.HIP, cuhk.KNEE, cuhk.HIP)]
    said = assess(LEG, swings, noise=0.3)
    identifiability = dict(zip(said.precision.names, said.precision.identifiability, strict=True))
    assert {identifiability[name] for name in ("J1", "J2", "Ia_knee")} == {"not"}
    assert {identifiability[name] for name in ("X1", "X2", "Y1", "Y2", "c0_hip", "c0_knee")} == {"well"}
    assert any("quickly" in advice.what for advice in said.advice if "J1" in advice.parameters)


def test_a_slow_log_is_assessed_behind_the_cutoff_with_which_it_will_be_identified(multisine):
    """At 10 Hz a cut-off of 8 Hz is impossible; the default of identify is 2 Hz."""
    slow = log(multisine, 60.0)
    slow = exoid.Recording(slow.time[::10], slow.q[::10], joint_names=slow.joint_names)
    assert slow.sample_rate == pytest.approx(10.0)
    said = assess(LEG, slow, noise=0.3)
    expected = assess(LEG, slow, noise=0.3, preparation=exoid.signals.ZeroPhase(2.0))
    np.testing.assert_allclose(said.precision.std, expected.precision.std)


@pytest.mark.nightly
def test_a_rig_that_carries_a_plan_out_scatters_as_predicted():
    """Over noisy replicates on rigs that stick, slip and track imperfectly; the full number resolves 10 %."""
    replicates, std = (1000 if FULL else 60), (0.3, 0.3)
    plan = plan_excitation(LEG, noise=std, duration=60.0 if FULL else 20.0, starts=2)
    bench = Bench(
        ProportionalDerivative(2000.0, 100.0),
        IdealTorque(),
        Sensors(encoder_counts=2.0**16, torque_noise=std),
        Rates(control=500.0, log=plan.rate, step=2e-3),
    )
    truth = {"c0_hip": 1.445, "c0_knee": 0.593, "d_hip": 0.038, "d_knee": 0.192, "Ia_hip": 0.8, "Ia_knee": 0.8}
    rng, values = np.random.default_rng(5), []
    for _ in range(0, replicates, 50 if FULL else 60):
        plant = Plant.build(LEG, truth).repeat(50 if FULL else 60)
        run = run_motion(plant, plan.motions[0].reference, bench, plan.duration, rng)
        values += [identify(LEG, run.recording(k)).values for k in range(plant.count)]
    ratio = np.std(values, axis=0, ddof=1) / plan.precision.std
    error = 1.0 / np.sqrt(2.0 * len(values))
    print(f"\n{len(values)} rigs: {ratio.min():.3f} to {ratio.max():.3f}, each ± {error:.3f}")
    assert np.abs(ratio - 1.0).max() < max(0.1, 3.5 * error)
    assert np.sqrt((ratio**2).mean()) == pytest.approx(1.0, abs=max(0.05, 1.5 * error))
