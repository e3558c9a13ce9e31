"""Recordings that cannot give a trustworthy answer are refused, and the error says what is missing."""

import numpy as np
import pytest
from outcomes import refused
from swings import TERMS, Swing, log_of

import exoid
from exoid import Coulomb, ExoidError, Offset, Recording, Viscous
from exoid.errors import BadArgumentError, NotIdentifiableError, UnreadableInputError
from exoid.signals import FiniteDifference, MovingAverage, ZeroPhase

PLAIN = FiniteDifference()
HIP, KNEE, ANKLE = "left_hip", "left_knee", "left_ankle"
RIGHT = "right_hip", "right_knee", "right_ankle"


@pytest.fixture(scope="module")
def swing(leg):
    return Swing(leg, base=0.15)


def moved(swing, transform):
    """Recording of the same leg whose q, v and a pass a linear map of the joints, with the torque that goes with it."""
    q, v, a = (x @ np.asarray(transform, dtype=float).T for x in swing.motion)
    return log_of(swing.leg, swing.time, (q, v, a), swing.friction(v), exact=True)


def with_torque(swing, joint, value, share=1.0):
    """Recording in which the torque of a joint has one value in a share of the samples."""
    tau = swing.torque.copy()
    tau[: int(share * len(tau)), joint] = value
    return swing.recording(tau=tau)


def blind_to_the_knee(name):
    """Hip and knee move such that the shank keeps its attitude (doc. 2's validation motion): ∂τ/∂J2 = 0."""
    urdf = exoid.catalog.urdf_folder() / f"{name}.urdf"
    other = Swing(exoid.load_leg(name).from_urdf(urdf, (HIP, KNEE)))
    exoid.identify(other.leg, moved(other, [[1, 0], [1 if name == "cuhk" else -1, 0]]), TERMS)


def forwards_only(swing):
    """The hip turns only forwards: friction and sensor zero are the same column."""
    q = swing.motion[0].copy()
    q[:, 0] = 0.05 * swing.time
    recording = Recording(swing.time, q, tau=swing.torque, joint_names=swing.leg.joint_names)
    exoid.identify(swing.leg, recording, (Coulomb(smoothing=0.0), Offset()))


def of(recording, terms=TERMS, *arguments, **options):
    """Identify from a recording that a function makes of the swing."""
    return lambda swing: exoid.identify(swing.leg, recording(swing), terms, *arguments, **options)


def whole(swing):
    return swing.recording()


NI, BAD, IN = NotIdentifiableError, BadArgumentError, UnreadableInputError
REFUSALS = {
    # what a foot that is kept level, q1 + q2 + q3 = 0, or joints in lock step cannot tell apart
    "a level foot": (of(lambda s: moved(s, [[1, 0, 0], [0, 1, 0], [-1, -1, 0]])), NI, ("J1", "J2", "J3")),
    "lock step": (of(lambda s: moved(s, [[1, 0, 0]] * 3), None), NI, ("J1", "J2", "J3", "Ia_knee", "Ia_ankle")),
    "a motion blind to the knee": (lambda s: blind_to_the_knee("bleex"), NI, ("J1", "J2")),
    "a motion blind to the knee of document 2": (lambda s: blind_to_the_knee("cuhk"), NI, ("J1", "J2")),
    "a hip that turns only forwards": (forwards_only, NI, ("c0_hip", "offset_hip")),
    "ten samples": (of(lambda s: s.recording().slice(0, 10), preparation=PLAIN), NI, ("X1", "Y1", "J1", "c0_hip")),
    "one sample a joint": (of(lambda s: s.recording().slice(0, 150), None, cutoff=2.5), NI, ()),
    "too short for the filter": (of(lambda s: s.recording().slice(0, 14), preparation=ZeroPhase()), ExoidError, ()),
    "too short for its cut-off": (of(lambda s: s.recording().slice(0, 50), preparation=ZeroPhase(20.0)), IN, ()),
    "too short for an average": (of(lambda s: s.recording().slice(0, 30), preparation=MovingAverage(0.2)), IN, ()),
    "one joint moves": (of(lambda s: moved(s, np.diag([0.0, 1.0, 0.0]))), NI, (HIP,)),
    "a dead band": (of(whole, (Coulomb(dead_band=50.0), Viscous())), NI, ()),
    "one dead band": (
        of(whole, (Coulomb(dead_band=50.0, joints=("ankle",)), Viscous())),
        NI,
        ("c0_ankle", "d_ankle"),
    ),
    "no torque": (of(lambda s: s.recording(tau=None)), IN, ()),
    "a missing joint": (of(lambda s: s.recording().select((HIP, KNEE))), IN, (ANKLE,)),
    "joints of the other side": (of(lambda s: s.recording(joint_names=RIGHT)), IN, (HIP, KNEE, ANKLE)),
    "a dead hip": (of(lambda s: with_torque(s, 0, -0.0)), NI, (HIP,)),
    "a dead ankle": (of(lambda s: with_torque(s, 2, 3.25), TERMS, "ols"), NI, (ANKLE,)),
    "all torques zero": (of(lambda s: s.recording(tau=0.0 * s.torque)), NI, (HIP, KNEE, ANKLE)),
    "a sensor switched on late": (of(lambda s: with_torque(s, 1, 0.0, share=0.6)), NI, (KNEE,)),
    "an unknown estimator": (of(whole, TERMS, "median"), ExoidError, ()),
    "a term twice": (of(whole, (Viscous(), Viscous())), ExoidError, ()),
    "two settings of one term": (of(whole, (Coulomb(), Coulomb(smoothing=0.1))), ExoidError, ()),
    "the name of a leg": (lambda s: exoid.identify("bleex", whole(s)), BAD, ()),
    "a number for a preparation": (of(whole, preparation=8.0), BAD, ()),
    "no recordings": (of(lambda s: iter(())), BAD, ()),
    "a path for a recording": (of(lambda s: ["log.csv"]), BAD, ()),
    "the name of a term": (of(whole, "coulomb"), BAD, ()),
    "the class of a term": (of(whole, (Coulomb,)), BAD, ()),
    "a cut-off for terms": (of(whole, 5.0), BAD, ()),
    "a cut-off of zero": (of(whole, cutoff=0.0), BAD, ()),
    "a cut-off beyond half the rate": (of(whole, cutoff=60.0), ExoidError, ()),
    "no number for a cut-off": (of(whole, cutoff=float("nan")), BAD, ()),
}


@pytest.mark.parametrize("case", REFUSALS, ids=lambda name: name.replace(" ", "-"))
def test_what_gives_no_trustworthy_answer_is_refused_with_its_evidence(swing, case):
    call, kind, evidence = REFUSALS[case]
    error = refused(kind, lambda: call(swing))
    assert set(evidence) == {*error.parameters, *error.joints}
    assert error.remedy


@pytest.mark.parametrize("joint", range(3))
def test_a_joint_that_stands_still_is_named_with_the_way_to_lock_it(swing, joint):
    still = np.eye(3)
    still[joint, joint] = 0.0
    with pytest.raises(NotIdentifiableError, match="locked=") as caught:
        exoid.identify(swing.leg, moved(swing, still), TERMS)
    assert caught.value.joints == (swing.leg.joint_names[joint],)


def test_locking_the_still_joint_as_the_error_says_works(swing):
    recording = moved(swing, np.diag([1.0, 1.0, 0.0]))
    hip, knee, ankle = swing.leg.joint_names
    urdf = exoid.catalog.urdf_folder() / "bleex.urdf"
    leg = exoid.Leg.from_urdf(urdf, joints=(hip, knee), locked={ankle: 0.0})
    estimate = exoid.identify(leg, recording, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.values[:6], leg.parameters, rtol=1e-8)


def test_a_poor_motion_that_still_determines_everything_prints_a_warning(leg):
    """Half a degree of noise-free motion at one slow frequency: solvable, not trustworthy, and it says so."""
    swing = Swing(leg, seconds=30.0)
    recording = log_of(leg, swing.time, [0.02 * x for x in swing.motion], exact=True)
    estimate = exoid.identify(leg, recording, (Offset(),), preparation=PLAIN)
    assert estimate.condition_number > 100.0
    assert "ill-conditioned: excite more" in str(estimate)


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
    for name in ("c0_hip", "c0_knee", "c0_ankle", "d_hip", "d_knee", "d_ankle"):
        assert estimate[name].identifiability == "not"
    assert "ill-conditioned" in str(estimate)
    assert any("d_hip" in warning for warning in estimate.warnings)


def test_ten_samples_of_a_single_joint_give_no_confident_number():
    """Enough to solve, as there are few parameters, but nothing is determined well."""
    names = exoid.load_leg("bleex").joint_names
    urdf = exoid.catalog.urdf_folder() / "bleex.urdf"
    leg = exoid.Leg.from_urdf(urdf, names[:1], locked=dict.fromkeys(names[1:], 0.0))
    recording = Swing(leg, 100.0).with_noise(np.random.default_rng(0), 1.0).slice(0, 10)
    estimate = exoid.identify(leg, recording, TERMS, preparation=PLAIN)
    assert "well" not in estimate.identifiability
