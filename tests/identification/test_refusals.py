"""Recordings that cannot give a trustworthy answer are refused, and the error says what is missing."""

import numpy as np
import pytest
from swings import TERMS, Swing

import exoid
from exoid import Armature, Coulomb, ExoidError, Offset, Recording, Stiffness, Viscous
from exoid.signals import FiniteDifference, MovingAverage, ZeroPhase

PLAIN = FiniteDifference()


@pytest.fixture(scope="module")
def leg():
    return exoid.load_leg("bleex")


@pytest.fixture(scope="module")
def swing(leg):
    return Swing(leg, base=0.15)


def moved(swing, transform):
    """Recording of the same leg whose q, v and a pass a linear map of the joints, with the torque that goes with it."""
    q, v, a = (x @ np.asarray(transform, dtype=float).T for x in swing.motion)
    tau = swing.leg.inverse_dynamics(q, v, a) + swing.coulomb * np.tanh(v / 0.02) + swing.viscous * v
    return swing.recording(q=q, v=v, a=a, tau=tau)


@pytest.mark.parametrize("joint", range(3))
def test_a_joint_that_stands_still_is_named_with_the_way_to_lock_it(swing, joint):
    names = swing.leg.joint_names
    still = np.eye(3)
    still[joint, joint] = 0.0
    others = ", ".join(repr(name) for name in names if name != names[joint])
    with pytest.raises(ExoidError, match=rf"joint {names[joint]} stands still.*joints=\({others}\), locked=\{{") as e:
        exoid.identify(swing.leg, moved(swing, still), TERMS)
    assert names[joint] in e.value.what
    assert e.value.remedy


def test_locking_the_still_joint_as_the_error_says_works(swing):
    recording = moved(swing, np.diag([1.0, 1.0, 0.0]))
    hip, knee, ankle = swing.leg.joint_names
    urdf = exoid.catalog.urdf_folder() / "bleex.urdf"
    leg = exoid.Leg.from_urdf(urdf, joints=(hip, knee), locked={ankle: 0.0})
    estimate = exoid.identify(leg, recording, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.values[:6], leg.parameters, rtol=1e-8)


def test_a_foot_kept_level_cannot_tell_the_inertias_apart(swing):
    """With q1 + q2 + q3 = 0 the foot never turns: its inertia, which is part of all three J, does nothing."""
    with pytest.raises(ExoidError, match=r"J1, J2, J3 cannot be told apart.*move all joints") as e:
        exoid.identify(swing.leg, moved(swing, [[1, 0, 0], [0, 1, 0], [-1, -1, 0]]), TERMS)
    assert "X" not in e.value.what


def test_joints_in_lock_step_cannot_tell_inertias_from_rotors(swing):
    with pytest.raises(ExoidError, match=r"J1, J2, J3, Ia_knee, Ia_ankle cannot be told apart"):
        exoid.identify(swing.leg, moved(swing, [[1, 0, 0], [1, 0, 0], [1, 0, 0]]))


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_validation_motion_that_is_blind_to_the_knee_is_refused(name):
    """Hip and knee move such that the shank keeps its attitude (doc. 2's validation motion): ∂τ/∂J2 = 0."""
    swing = Swing(
        exoid.load_leg(name).from_urdf(exoid.catalog.urdf_folder() / f"{name}.urdf", ("left_hip", "left_knee"))
    )
    transform = [[1, 0], [1 if name == "cuhk" else -1, 0]]
    with pytest.raises(ExoidError, match="J2"):
        exoid.identify(swing.leg, moved(swing, transform), TERMS)


def test_one_joint_after_another_is_enough_without_rotors(swing):
    """Not everything that looks poor is: three motions of one joint each determine all nine parameters."""
    motions = [moved(swing, np.diag(row)) for row in np.eye(3)]
    estimate = exoid.identify(swing.leg, motions, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.values, swing.truth, rtol=1e-8)


def test_a_hip_that_moves_while_another_recording_moves_the_rest_is_not_still(swing):
    motions = [moved(swing, np.diag([1.0, 0.0, 0.0])), moved(swing, np.diag([0.0, 1.0, 1.0]))]
    estimate = exoid.identify(swing.leg, motions, TERMS, preparation=PLAIN)
    assert estimate.condition_number < 100.0


def test_a_term_that_left_no_trace_is_named(swing):
    """The hip turns only forwards: friction and sensor zero are the same column."""
    q = swing.motion[0].copy()
    q[:, 0] = 0.05 * swing.time
    recording = Recording(swing.time, q, tau=swing.torque, joint_names=swing.leg.joint_names)
    with pytest.raises(ExoidError, match=r"c0_hip.*offset_hip"):
        exoid.identify(swing.leg, recording, (Coulomb(smoothing=0.0), Offset()))


@pytest.mark.parametrize("terms", [(Coulomb(dead_band=50.0), Viscous()), (Coulomb(smoothing=0.0, dead_band=50.0),)])
def test_a_dead_band_that_leaves_no_sample_is_named(swing, terms):
    with pytest.raises(ExoidError, match=r"left_hip, left_knee, left_ankle is faster than the dead band"):
        exoid.identify(swing.leg, swing.recording(), terms)


def test_a_dead_band_that_leaves_no_sample_of_one_joint_names_that_joint(swing):
    terms = (Coulomb(dead_band=50.0, joints=("ankle",)), Viscous())
    with pytest.raises(ExoidError, match=r"no sample of left_ankle is faster.*smaller dead_band"):
        exoid.identify(swing.leg, swing.recording(), terms)


def test_a_recording_without_torque_is_refused(swing):
    with pytest.raises(ExoidError, match=r"no torque.*tau_left_hip, tau_left_knee, tau_left_ankle"):
        exoid.identify(swing.leg, swing.recording(tau=None))


def test_a_missing_joint_is_named(swing):
    with pytest.raises(ExoidError, match=r"left_ankle not in the recording, which has left_hip, left_knee.*columns="):
        exoid.identify(swing.leg, swing.recording().select(("left_hip", "left_knee")))


@pytest.mark.parametrize(
    ("samples", "preparation"), [(100, ZeroPhase()), (50, ZeroPhase(cutoff=20.0)), (30, MovingAverage(0.2))]
)
def test_a_record_that_consists_of_ends_is_refused(swing, samples, preparation):
    with pytest.raises(ExoidError, match=r"too few.*record longer or choose a higher cut-off"):
        exoid.identify(swing.leg, swing.recording().slice(0, samples), TERMS, preparation=preparation)


def test_a_dozen_samples_cannot_determine_twenty_parameters(swing):
    with pytest.raises(ExoidError, match=r"do not determine every parameter: X1, Y1, J1, .* cannot be told apart"):
        exoid.identify(swing.leg, swing.recording().slice(0, 10), preparation=PLAIN)


def test_one_independent_sample_a_joint_is_too_few(swing):
    with pytest.raises(ExoidError, match=r"too few samples: .* independent ones for 20 parameters.*record longer"):
        exoid.identify(swing.leg, swing.recording().slice(0, 330), cutoff=2.5)


def test_labels_without_a_side_are_accepted(swing):
    plain = swing.recording(joint_names=("hip", "knee", "ankle"))
    estimate = exoid.identify(swing.leg, plain, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.values, swing.truth, rtol=1e-8)


def test_labels_of_the_other_side_are_not(swing):
    other = swing.recording(joint_names=("right_hip", "right_knee", "right_ankle"))
    with pytest.raises(ExoidError, match=r"left_hip, left_knee, left_ankle not in the recording, which has right_hip"):
        exoid.identify(swing.leg, other, TERMS)


def test_further_joints_of_the_recording_are_ignored(swing):
    q, v, a = (np.column_stack([x[:, 2], x, x[:, 0]]) for x in swing.motion)
    tau = np.column_stack([swing.torque[:, 2], swing.torque, np.zeros(len(q))])
    names = ("thumb", *swing.leg.joint_names, "toe")
    recording = Recording(swing.time, q, v, a, tau, joint_names=names)
    estimate = exoid.identify(swing.leg, recording, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.values, swing.truth, rtol=1e-8)


def test_an_unknown_estimator_is_refused_with_those_there_are(swing):
    with pytest.raises(ExoidError, match=r"no estimator 'median'.*ols, .*wls"):
        exoid.identify(swing.leg, swing.recording(), TERMS, "median")


def test_stiffness_and_offset_are_one_parameter_and_the_estimate_says_so(swing):
    estimate = exoid.identify(swing.leg, swing.recording(), (*TERMS, Stiffness(joints=("ankle",)), Offset()))
    assert [regrouped.name for regrouped in estimate.regrouped] == ["offset_ankle"]
    assert "offset_ankle" not in estimate.names
    assert "note: offset_ankle is regrouped into b0_ankle: no motion distinguishes them" in str(estimate)


def test_a_rotor_at_the_hip_is_part_of_j1_and_the_estimate_says_so(swing):
    a = swing.motion[2]
    tau = swing.torque + 0.3 * a * [1.0, 0.0, 0.0]
    estimate = exoid.identify(swing.leg, swing.recording(tau=tau), (*TERMS, Armature()), preparation=PLAIN)
    assert estimate.value("J1") == pytest.approx(swing.leg.parameters[2] + 0.3, rel=1e-8)
    assert "note: Ia_hip is regrouped into J1: no motion distinguishes them" in str(estimate)


def test_the_same_term_twice_is_refused(swing):
    with pytest.raises(ExoidError, match="c0_ankle, c0_hip, c0_knee"):
        exoid.identify(swing.leg, swing.recording(), (Coulomb(), Coulomb(smoothing=0.1)))


@pytest.mark.parametrize("estimator", ["ols", "wls"])
@pytest.mark.parametrize("value", [0.0, -0.0, 3.25])
@pytest.mark.parametrize("joint", [0, 2])
def test_a_torque_that_never_changes_is_a_dead_channel(swing, joint, value, estimator):
    tau = swing.torque.copy()
    tau[:, joint] = value
    name = swing.leg.joint_names[joint]
    with pytest.raises(ExoidError, match=rf"torque of joint {name} is {abs(value):g} N·m in every sample.*tau_{name}"):
        exoid.identify(swing.leg, swing.recording(tau=tau), TERMS, estimator)


@pytest.mark.parametrize("estimator", ["ols", "wls"])
def test_torques_that_are_all_zero_are_refused(swing, estimator):
    with pytest.raises(ExoidError, match="left_hip is 0 N·m in every sample"):
        exoid.identify(swing.leg, swing.recording(tau=np.zeros_like(swing.torque)), TERMS, estimator)


def test_a_free_swing_beside_a_driven_one_is_not_a_dead_channel(swing):
    """A joint may swing freely in one recording if another shows that its torque channel lives."""
    free = np.zeros_like(swing.torque)
    with pytest.raises(ExoidError, match="left_hip is 0 N·m in every sample"):
        exoid.identify(swing.leg, swing.recording(tau=free))
    estimate = exoid.identify(swing.leg, [swing.recording(), swing.recording(tau=free)], TERMS)
    assert np.isfinite(estimate.values).all()


@pytest.mark.parametrize("recordings", [[], (), iter(())])
def test_no_recordings_are_refused(leg, recordings):
    with pytest.raises(ExoidError, match="no recordings"):
        exoid.identify(leg, recordings)


@pytest.mark.parametrize("recordings", ["log.csv", ["log.csv"]])
def test_a_path_in_place_of_a_recording_is_refused_with_the_way_to_read_it(leg, recordings):
    with pytest.raises(ExoidError, match=r"'log\.csv' is no recording.*from_csv"):
        exoid.identify(leg, recordings)


@pytest.mark.parametrize("terms", ["coulomb", ("coulomb",), (Coulomb,), [Coulomb(), None]])
def test_names_of_terms_in_place_of_terms_are_refused(swing, terms):
    with pytest.raises(ExoidError, match=r"is no term.*exoid\.Coulomb\(\)"):
        exoid.identify(swing.leg, swing.recording(), terms)


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 60.0, float("nan"), float("inf")])
def test_an_impossible_cutoff_is_refused(swing, cutoff):
    with pytest.raises(ExoidError, match=r"cut-?off"):
        exoid.identify(swing.leg, swing.recording(), TERMS, cutoff=cutoff)


def test_a_poor_motion_that_still_determines_everything_prints_a_warning(leg):
    """Half a degree of noise-free motion at one slow frequency: solvable, not trustworthy, and it says so."""
    swing = Swing(leg, seconds=30.0)
    q, v, a = (0.02 * x for x in swing.motion)
    recording = swing.recording(q=q, v=v, a=a, tau=leg.inverse_dynamics(q, v, a))
    estimate = exoid.identify(leg, recording, (Offset(),), preparation=PLAIN)
    assert estimate.condition_number > 100.0
    assert "ill-conditioned: excite more" in str(estimate)


@pytest.mark.parametrize("joint", range(3))
def test_a_torque_that_is_zero_in_most_rows_is_named(swing, joint):
    """A sensor that was switched on late: its zeros would pass for torques."""
    tau = swing.torque.copy()
    tau[: int(0.6 * len(tau)), joint] = 0.0
    with pytest.raises(ExoidError, match=rf"torque of joint {swing.leg.joint_names[joint]} is 0 N·m in 60% of") as e:
        exoid.identify(swing.leg, swing.recording(tau=tau), TERMS)
    assert "Recording.between" in e.value.remedy


def test_a_recording_that_moves_one_joint_only_is_refused(swing):
    """Two joints stand still; with their angles told apart by encoder noise alone they still do."""
    recording = moved(swing, np.diag([0.0, 1.0, 0.0]))
    with pytest.raises(ExoidError, match="stands still"):
        exoid.identify(swing.leg, recording, TERMS)
    noisy = recording.q + np.random.default_rng(0).normal(scale=1e-4, size=recording.q.shape)
    with pytest.raises(ExoidError, match="stands still"):
        exoid.identify(swing.leg, swing.recording(q=noisy, v=None, a=None, tau=recording.tau), TERMS)


def test_friction_columns_that_are_the_same_up_to_scale_become_one_parameter_and_the_estimate_says_so(swing):
    """tanh(v / 1e5) is v / 1e5: no motion tells such Coulomb friction from viscous friction."""
    estimate = exoid.identify(swing.leg, swing.recording(), (Coulomb(smoothing=1e5), Viscous()))
    assert "d_hip" not in estimate.names
    assert "note: d_hip is regrouped into c0_hip" in str(estimate)


@pytest.mark.parametrize("smoothing", [10.0, 30.0])
def test_friction_columns_that_are_nearly_the_same_are_not_determined(swing, smoothing):
    """Never a confident number: two values that cancel are told from their size, whatever their error."""
    recording = swing.with_noise(np.random.default_rng(0), 0.5)
    estimate = exoid.identify(swing.leg, recording, (Coulomb(smoothing=smoothing), Viscous()))
    identifiability = dict(zip(estimate.names, estimate.identifiability, strict=True))
    for name in ("c0_hip", "c0_knee", "c0_ankle", "d_hip", "d_knee", "d_ankle"):
        assert identifiability[name] == "not"
    assert "ill-conditioned" in str(estimate)
    assert any("d_hip" in warning for warning in estimate.warnings)


def test_two_friction_terms_of_one_shape_are_refused(swing):
    """They would even have the same names."""
    with pytest.raises(ExoidError, match="occur twice"):
        exoid.identify(swing.leg, swing.recording(), (Viscous(), Viscous()))


@pytest.mark.parametrize("preparation", [None, PLAIN], ids=["default", "plain"])
def test_ten_samples_are_refused(swing, preparation):
    with pytest.raises(ExoidError, match=r"10 samples|cannot be told apart"):
        exoid.identify(swing.leg, swing.recording().slice(0, 10), TERMS, preparation=preparation)


def test_ten_samples_of_a_single_joint_give_no_confident_number():
    """Enough to solve, as there are few parameters, but nothing is determined well."""
    names = exoid.load_leg("bleex").joint_names
    urdf = exoid.catalog.urdf_folder() / "bleex.urdf"
    leg = exoid.Leg.from_urdf(urdf, names[:1], locked=dict.fromkeys(names[1:], 0.0))
    swing = Swing(leg, 100.0)
    recording = swing.with_noise(np.random.default_rng(0), 1.0).slice(0, 10)
    estimate = exoid.identify(leg, recording, TERMS, preparation=PLAIN)
    assert "well" not in estimate.identifiability
