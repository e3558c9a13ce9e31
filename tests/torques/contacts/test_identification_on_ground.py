"""Identification of an exoskeleton that stands: mass without a force plate, wrong contacts, IMU errors, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from made_estimates import from_file
from scipy.spatial.transform import Rotation
from standing import GRAVITY, TERMS, Standing, friction, mirrored, session, standing, with_imu
from unchecked import identify

import exoid
from exoid import BaseMotion, ExoidError, Wrench
from exoid.estimate.friction_cone import cone_findings
from exoid.estimate.ground_prediction import level_wrench
from exoid.signals import ZeroPhase
from exoid.torques.contacts import refuse_dead_switches, split
from exoid.torques.contacts.imu import CorrectedBase
from exoid.torques.contacts.standing_base import tilt_of_sole

NOISE, ENCODER = 0.4, 1e-4
AIR = dict.fromkeys(("left_foot", "right_foot"), np.zeros(3750, dtype=bool))
KINDS = "torque-scale", "angle-offset", "unmodelled-force", "torque-offset"


def logs(exo, seed=0, seconds=15.0) -> list[Standing]:
    return session(exo, 3 * seed, seconds=seconds, noise=NOISE, encoder=ENCODER, friction=friction)


@pytest.fixture(scope="module")
def stance(exo):
    return logs(exo)


@pytest.fixture(scope="module")
def estimate(exo, stance):
    return identify(exo, [log.recording for log in stance], TERMS)


def deviations(exo, estimate):
    """Errors of the rigid-body parameters over their standard deviations."""
    count = len(exo.parameters)
    return (estimate.values[:count] - exo.parameters) / estimate.std[:count]


@pytest.mark.slow
def test_mass_and_segments_follow_without_a_force_plate(exo, estimate):
    error = np.abs(estimate.values[: len(exo.parameters)] / exo.parameters - 1.0)
    of = dict(zip(exo.parameter_names, error, strict=True))
    assert of["M"] < 0.001
    assert max(of[name] for name in of if name[0] == "X") < 0.01
    assert max(of[name] for name in of if name[0] == "J") < 0.04
    assert np.sqrt(np.mean(deviations(exo, estimate) ** 2)) < 1.6


def test_the_estimate_survives_a_file(estimate, tmp_path):
    again = from_file(estimate, tmp_path)
    assert (str(again), again.supports, *again.values) == (str(estimate), estimate.supports, *estimate.values)
    recorded = sum(one.samples / one.sample_rate for one in estimate.inputs)
    assert 0.5 * recorded < sum(one.seconds for one in estimate.supports) <= recorded


@pytest.mark.parametrize("first", [pytest.param(0, marks=pytest.mark.nightly), 1])
def test_the_order_of_logs_changes_neither_cut_off_nor_bands(exo, stance, first):
    """Also where each foot alone rests for the same time."""
    data = [log.recording for log in stance[first:]]
    one, other = (identify(exo, logs, TERMS) for logs in (data, data[::-1]))
    assert one.preparation == other.preparation
    np.testing.assert_allclose(one.residual_rms, other.residual_rms, rtol=1e-6)


def with_plates(log, rng, late=0):
    """Record the wrenches, too, with the noise of plates, and so many samples late."""
    noisy = {}
    for link, x in log.wrenches.items():
        both = (part + size * rng.standard_normal(part.shape) for part, size in ((x.force, 3.0), (x.moment, 0.3)))
        noisy[link] = Wrench(*(np.roll(part, late, axis=0) for part in both))
    return replace(log.recording, wrenches=noisy)


@pytest.mark.slow
def test_measured_wrenches_fix_the_mass_and_disturb_nothing_else(exo, stance, estimate):
    rng = np.random.default_rng(1)
    recordings = [replace(with_plates(log, rng), contacts=AIR | log.recording.contacts) for log in stance]
    found = identify(exo, recordings, TERMS)
    assert abs(found["M"].value / exo.parameters[0] - 1.0) < 0.001
    assert np.sqrt(np.mean(deviations(exo, found) ** 2)) < 1.6
    assert found["M"].std < estimate["M"].std
    wider = found.std / estimate.std
    assert np.exp(np.mean(np.log(wider))) < 1.0  # plates of 3 N and 0.3 N·m were in every row of a joint
    assert wider.max() < 1.3


CARRIED = {"payloads": (exoid.Payload("torso", 8.0, (0.05, 0.1, 0.3)),)}


@pytest.mark.parametrize(("feet", "options"), [("both", {}), ("left", {}), ("both", CARRIED)])
def test_ground_force_and_centre_of_pressure_follow_from_torques(exo, estimate, feet, options):
    log = standing(exo, feet, seconds=12.0, seed=99, noise=NOISE, encoder=ENCODER, friction=friction, **options)
    for link, found in exoid.ground_forces(estimate, log.recording).items():
        true = level_wrench(exo, log.recording.q, link, log.wrenches[link])
        rows = np.searchsorted(log.recording.time, found.time)[50:-50]
        error = (found.force - true.force[np.searchsorted(log.recording.time, found.time)])[50:-50]
        assert np.sqrt(np.mean(error[:, 2] ** 2)) < 0.005 * GRAVITY * exo.parameters[0]
        inside = np.abs(error[:, [0, 2]]) <= found.force_half[50:-50][:, [0, 2]]
        assert inside.mean() > 0.85
        apart = found.center_of_pressure(-0.08)[50:-50] - true.center_of_pressure(-0.08)[rows]
        assert np.sqrt(np.mean(apart[:, 0] ** 2)) < 0.005


def test_what_the_torques_of_a_planar_leg_do_not_tell_has_an_infinite_band(exo, estimate):
    log = standing(exo, "both", seconds=6.0, seed=98, noise=NOISE, encoder=ENCODER, friction=friction)
    for found in exoid.ground_forces(estimate, log.recording).values():
        assert np.isinf(np.column_stack([found.force_half[:, 1], found.moment_half[:, [0, 2]]])).all()
        assert np.isfinite(np.column_stack([found.force_half[:, [0, 2]], found.moment_half[:, 1]])).all()
        assert np.isnan(found.center_of_pressure(-0.08)).mean(axis=0).tolist() == [0.0, 1.0]


def wrongly(log, link, value, seed):
    """Label 5 % of the samples of a link wrongly, in two pieces."""
    rng, recording = np.random.default_rng(seed), log.recording
    contacts = {name: np.array(flags) for name, flags in recording.contacts.items()}
    contacts.setdefault(link, np.zeros(len(recording), dtype=bool))
    for start in rng.uniform(1.0, 18.0, 2):
        first = int(start * recording.sample_rate)
        contacts[link][first : first + int(0.5 * recording.sample_rate)] = value
    return replace(recording, contacts=contacts)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "joint", "size"),
    [
        *(("torque-scale", 1, 1.15), ("angle-offset", 0, 0.04)),
        *(("unmodelled-force", 1, 40.0), ("torque-offset", 4, -4.0)),
        *(
            pytest.param(*each, marks=pytest.mark.nightly)
            for each in (("torque-scale", 3, 0.9), ("angle-offset", 4, -0.04), ("torque-offset", 0, 2.0))
        ),
    ],
)
def test_a_fault_of_one_joint_is_named(exo, stance, kind, joint, size):
    """A knee of 1.1 times its torque made its thigh too light in silence, and a wrong zero was a foot that rocks."""
    factor, zero, spring, offset = each = np.array([[1.0] * 6, *np.zeros((3, 6))])
    each[KINDS.index(kind), joint] = size
    every = [log.recording for log in stance]
    logs = [replace(one, tau=one.tau * factor + one.q * spring + offset, q=one.q + zero) for one in every]
    findings = exoid.identify(exo, logs, TERMS).findings
    assert not {"rocking-foot", "torque-sign"} & {one.kind for one in findings}
    found = {one.joint: one for one in findings if one.kind in KINDS}
    one = found.pop(exo.joint_names[joint])
    assert {one.kind, *(other.kind for other in found.values())} == {kind}
    assert one.interval[0] - 0.005 * abs(size) < size < one.interval[1] + 0.005 * abs(size)
    # without an IMU, the other hip may be too little far
    opposite = {"right_hip": -size} if (kind, joint) == ("angle-offset", 0) else {}
    assert {name: other.value for name, other in found.items()} == pytest.approx(opposite, abs=0.005)


@pytest.mark.slow
def test_zeros_of_both_knees_and_a_slow_clock_are_named(exo, stance):
    """No single joint explains both knees: M was 3 % off in intervals of 0.1 %. A slow clock was a wrong load cell."""
    every, knees = [log.recording for log in stance], 0.05 * np.array([0, 1, 0, 0, 1, 0])
    bent = exoid.identify(exo, [replace(one, q=one.q + knees) for one in every], TERMS).findings
    told = {one.joint: one.value for one in bent if one.kind in KINDS}
    assert told == pytest.approx({"left_knee": 0.05, "right_knee": 0.05}, abs=0.005)
    slow = exoid.identify(exo, [replace(one, time=0.9 * one.time) for one in every], TERMS).findings
    (clock,) = [one for one in slow if one.kind in (*KINDS, "clock", "known-torque")]
    assert (clock.kind, clock.value) == ("clock", pytest.approx(-0.1, abs=0.01))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["swing labelled as stance", "stance labelled as swing"])
def test_wrong_contacts_are_left_out(exo, stance, estimate, kind):
    both, left, right = stance
    if kind == "swing labelled as stance":
        recordings = [both.recording, wrongly(left, "right_foot", True, 1), wrongly(right, "left_foot", True, 2)]
    else:
        recordings = [wrongly(both, "right_foot", False, 3), left.recording, right.recording]
    found = exoid.identify(exo, recordings, terms=TERMS)
    assert np.abs((found.values - estimate.values) / estimate.std).max() < 1.0
    said = {finding.kind: finding.value for finding in found.findings}
    assert said["slipping-contact" if kind == "swing labelled as stance" else "wrong-contact"] > 0.02


@pytest.mark.slow
def test_bias_of_an_imu_is_found_while_a_foot_rests(exo, stance):
    found = exoid.identify(exo, [with_imu(log, k) for k, log in enumerate(stance)], terms=TERMS)
    assert np.sqrt(np.mean(deviations(exo, found) ** 2)) < 1.6
    (first, *_) = [finding for finding in found.findings if finding.kind == "imu-bias"]
    assert first.value == pytest.approx(np.hypot(0.1, 0.15), abs=0.005)
    assert not [finding for finding in found.findings if finding.kind == "large-residual"]


def displaced(log, place, seed):
    base, omega = log.base, log.base.angular_velocity
    more = np.cross(base.angular_acceleration, place) + np.cross(omega, np.cross(omega, place))
    return with_imu(log._replace(base=replace(base, specific_force=base.specific_force + more)), seed)


@pytest.mark.slow
@pytest.mark.parametrize(("height", "severity"), [(0.2, "error"), (0.04, "warning")])
def test_a_sensor_that_is_elsewhere_is_named(exo, stance, height, severity):
    logs = [displaced(log, (0.0, 0.0, height), k) for k, log in enumerate(stance)]
    found = [one for one in exoid.check(exo, logs, terms=TERMS) if one.kind == "imu-position"]
    assert [one.severity for one in found] == [severity]
    assert found[0].value == pytest.approx(height, abs=0.005)


@pytest.mark.slow
def test_an_accelerometer_that_reads_too_much_is_named(exo, stance):
    """Its scale was taken for a sensor that is 4 cm elsewhere, or passed unseen."""
    logs = [with_imu(log, k) for k, log in enumerate(stance)]
    more = [replace(one, base=replace(one.base, specific_force=1.03 * one.base.specific_force)) for one in logs]
    found = [one for one in exoid.check(exo, more, terms=TERMS) if one.kind in ("imu-position", "imu-scale")]
    assert [(one.kind, one.value) for one in found] == [("imu-scale", pytest.approx(1.03, abs=0.005))]


@pytest.mark.parametrize("late", [0, 6])
def test_soles_that_yield_are_no_late_sensor(exo, stance, late):
    """Soft ground lags behind the torque on it: such a sensor was said to be 43 ms late."""
    log = with_imu(stance[1], 1)
    tilt = tilt_of_sole(exo, log, "left_foot")
    lean = 3e-4 * tilt + 1e-4 * np.gradient(tilt, log.time, axis=0)
    force = log.base.specific_force + np.cross(log.base.specific_force, lean)
    base = replace(log.base, specific_force=force).rows(np.maximum(np.arange(len(log)) - late, 0))
    delay = split(exo, replace(log, base=base)).delay
    assert delay == pytest.approx(late / log.sample_rate, abs=0.006)
    rocks = np.cumsum(np.random.default_rng(0).normal(0.0, 3e-4, (len(log), 3)), axis=0)  # nothing is told
    base = replace(base, specific_force=base.specific_force + np.cross(base.specific_force, rocks))
    assert split(exo, replace(log, base=base)).delay == 0.0


@pytest.mark.slow
def test_a_sensor_that_is_late_is_named_and_moved(exo, stance):
    """Before, feet were said to rock, and no bias was taken out."""
    logs = [with_imu(log, k) for k, log in enumerate(stance)]
    for samples, named in ((0, []), (12, 3 * ["imu-delay"])):
        late = [replace(log, base=log.base.rows(np.maximum(np.arange(len(log)) - samples, 0))) for log in logs]
        found = identify(exo, late, TERMS)
        told = [one for one in found.findings if one.kind in ("imu-delay", "rocking-foot", "imu-position")]
        assert [one.kind for one in told] == named
        assert [one.value for one in told] == pytest.approx([0.048] * len(named), abs=0.003)
        assert np.sqrt(np.mean(deviations(exo, found) ** 2)) < 1.6


@pytest.mark.parametrize(("calibrated", "samples", "delay"), [(True, 12, 0.048), (False, -12, -0.048), (False, 0, 0.0)])
def test_a_sensor_is_late_or_early_also_where_no_bias_is_looked_for(exo, stance, calibrated, samples, delay):
    log = with_imu(stance[1], 1)
    rows = np.clip(np.arange(len(log)) - samples, 0, len(log) - 1)
    parts = split(exo, replace(log, base=replace(log.base.rows(rows), calibrated=calibrated)))
    assert parts.delay == pytest.approx(delay, abs=0.004)
    assert (parts.imu is None) == calibrated


@pytest.mark.nightly
@pytest.mark.parametrize("factor", [1.0, 0.5, 1.3])
def test_a_recording_whose_torques_have_another_scale_is_named(exo, stance, factor):
    """Before, parameters of a walker were off by 87 standard deviations without a word."""
    logs = [with_imu(log, k) for k, log in enumerate(stance)]
    logs[1] = replace(logs[1], tau=factor * logs[1].tau)
    told = [one for one in exoid.identify(exo, logs, terms=TERMS).findings if one.kind == "torque-scale"]
    assert [one.value for one in told] == pytest.approx([factor] * (factor != 1.0), rel=0.1)


@pytest.mark.slow
def test_a_recording_that_the_others_contradict_is_named(exo, stance):
    """Its rows lose their weight: no parameter shows it."""
    logs = [with_imu(log, k) for k, log in enumerate(stance)]
    logs[1] = replace(logs[1], tau=logs[1].tau * [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    told = [one for one in exoid.identify(exo, logs, terms=TERMS).findings if one.kind == "large-residual"]
    assert [one.joint for one in told] == ["left_hip"]


RIGHT = AIR | {"right_foot": np.ones(3750, dtype=bool)}
STRAIGHT, AROUND, ASKEW = (Rotation.from_euler("z", angle, degrees=True).as_matrix() for angle in (0.0, 180.0, 15.0))
PITCHED, TURNED = (Rotation.from_rotvec(x, degrees=True).as_matrix() for x in ([0.0, 10.0, 0.0], [60.0, 0.0, 60.0]))


@pytest.mark.parametrize(
    ("turn", "rate", "contacts", "message"),
    [
        pytest.param(AROUND, 1.0, {}, "-x, -y, z", id="a sensor that is mounted the other way round"),
        pytest.param(ASKEW, 1.0, {}, r"by 15° about \(-?0.00, -?0.00, 1.00\)", id="a sensor that is mounted askew"),
        pytest.param(PITCHED, 1.0, {}, r"by \d+° about \(-?0.\d\d, 1.00, ", id="a sensor that is pitched"),
        pytest.param(TURNED, 1.0, {}, r"by 8\d° about \(0.\d\d, ", id="a sensor that is turned about two axes"),
        pytest.param(STRAIGHT, 0.0, {}, "reads 0 times", id="a gyroscope that is dead"),
        pytest.param(STRAIGHT, 0.8, {}, "reads 0.8 times", id="a gyroscope of another range"),
        pytest.param(STRAIGHT, np.pi / 180.0, {}, "reads 0.017 times", id="rad/s that are read as degrees"),
        pytest.param(STRAIGHT, 1.0, RIGHT, "as if left_foot stood", id="switches that are interchanged"),
        pytest.param(STRAIGHT, 1.0, {"left_foot": RIGHT["left_foot"]}, "hardly any weight", id="an inverted switch"),
    ],
)
def test_a_base_that_moves_otherwise_than_its_foot_is_refused(exo, stance, turn, rate, contacts, message):
    """Before, torques had another sign or scale, or nothing was said."""
    log = with_imu(stance[1], 0)
    assert split(exo, log).stretches
    base = replace(log.base, angular_velocity=rate * log.base.angular_velocity @ turn.T)
    base = replace(base, specific_force=base.specific_force @ turn.T)
    with pytest.raises(ExoidError, match=message):
        split(exo, replace(log, base=base, contacts=contacts or log.contacts))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda q, _: q[:, [0, 4, 2, 3, 1, 5]], "the angles of left_knee and right_knee were interchanged"),
        (lambda q, _: q * [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0], "the angle of left_hip had the other sign"),
        (lambda q, _: q * [1.0, -1.0, 1.0, 1.0, 1.0, 1.0], "the angle of left_knee had the other sign"),
        (lambda q, t: q + 0.3 * np.outer(t > 5.0, np.arange(6) == 1), r"the angle of left_knee jumps at 5\.0"),
    ],
)
def test_angles_that_a_base_contradicts_are_refused(exo, stance, change, message):
    """Before, the foot was said to rock by 0.1 rad, and markers of the base to be lost."""
    log = with_imu(stance[1], 0)
    with pytest.raises(ExoidError, match=message):
        split(exo, replace(log, q=change(log.q, log.time)))


def test_a_base_that_hangs_over_its_foot_is_refused(exo, stance):
    log = stance[1].recording
    with pytest.raises(ExoidError, match="the base is upside down over left_foot"):
        split(exo, replace(log, q=log.q + [np.pi, 0.0, 0.0] * 2))


@pytest.mark.parametrize("pitch", [-1.0, -1.5, -2.0])
def test_a_sensor_that_leans_on_a_torso_at_rest_is_not_refused(exo, stance, pitch):
    """Turned about the vertical it would read nearly the same: it is off by 3°, and the torso by half of that."""
    log, leans, rng = with_imu(stance[1], 0), -np.deg2rad(pitch + 3.0), np.random.default_rng(0)
    q = np.tile([np.deg2rad(pitch) + 0.3, -0.6, 0.3], (len(log.time), 2)) + 1e-5 * rng.standard_normal(log.q.shape)
    force = 9.81 * np.array([np.sin(leans), 0.0, np.cos(leans)]) + 0.02 * rng.standard_normal((len(q), 3))
    base = replace(log.base, angular_velocity=0.002 * rng.standard_normal((len(q), 3)), specific_force=force)
    assert split(exo, replace(log, q=q, v=None, base=base)).stretches


def tipped(time):
    """Flat for most of the time, and on the toe or the heel by 20 mrad for a second each."""
    onto = [np.tanh((time - at) / 0.1) - np.tanh((time - at - 1.0) / 0.1) for at in (2.0, 5.0, 8.0)]
    return 0.01 * (onto[0] - onto[1] + onto[2])


def test_a_foot_that_tips_over_does_not_hide_the_bias(exo):
    bias = (0.1, 0.0, 0.15)
    for seed, tips in ((1, lambda _: 0.0), (1, tipped)):
        log = standing(exo, "left", seconds=12.0, seed=seed, noise=NOISE, encoder=ENCODER, friction=friction, sole=tips)
        errors = split(exo, with_imu(log, seed, force_bias=bias)).imu
        np.testing.assert_allclose(errors.force_bias, bias, atol=0.01)
        np.testing.assert_allclose(errors.gyro_bias, (0.0, 0.01, 0.0), atol=0.001)


@pytest.mark.nightly
def test_a_recording_without_rest_has_the_bias_of_its_session(exo, stance):
    """No foot rests in a swing: the bias of 1 % of gravity was 1 % of every X."""
    log = standing(exo, "left", seconds=15.0, seed=50, noise=NOISE, encoder=ENCODER, friction=friction)
    swing = replace(with_imu(log, 9), contacts={}, wrenches={"left_foot": log.wrenches["left_foot"]})
    # a load cell in place of the ground, on a foot that is said to move
    swing = replace(swing, contacts={"left_foot": np.zeros(len(swing), dtype=bool)})
    session = [with_imu(each, k) for k, each in enumerate(stance)]
    found = exoid.identify(exo, [*session, swing], terms=TERMS)
    assert np.sqrt(np.mean(deviations(exo, found) ** 2)) < 1.6
    assert [each.kind for each in found.findings if each.kind.startswith("imu")] == ["imu-bias"] * 4
    told = split(exo, session[0]).imu
    base = told.corrected(swing.base)
    columns = base.angular_velocity, base.specific_force, base.position
    by_hand = CorrectedBase(*columns, calibrated=True, told=told, own=False, bias=told.force_bias)
    again = identify(exo, [*session, replace(swing, base=by_hand)], TERMS)
    np.testing.assert_allclose(again.values, found.values, atol=0.2 * found.std.min())


@pytest.mark.slow
def test_a_bias_that_no_rest_tells_follows_from_the_rows(exo):
    """A bias of 1 % of gravity is 1 % of every X, where it is not found."""
    log = standing(exo, "left", seconds=15.0, seed=50, noise=NOISE, encoder=ENCODER, friction=friction)
    swing = replace(
        with_imu(log, 9),
        wrenches={"left_foot": log.wrenches["left_foot"]},
        contacts={"left_foot": np.zeros(len(log.recording), dtype=bool)},
    )
    found = exoid.identify(exo, swing, terms=TERMS)
    (bias,) = (each for each in found.findings if each.kind.startswith("imu"))
    assert bias.kind == "imu-bias"
    low, high = bias.interval
    assert low < np.hypot(0.1, 0.15) < high
    assert high - low < 0.1
    none = replace(with_imu(log, 9, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)).base, calibrated=True)
    unbiased, taken = (exoid.identify(exo, replace(swing, base=x), terms=TERMS) for x in (none, known(swing.base)))
    assert (np.abs(found.values - unbiased.values) < 2.0 * found.std).all()
    assert not [each for each in unbiased.findings if each.kind.startswith("imu")]
    assert abs(taken.values[0] - unbiased.values[0]) > 10.0 * found.std[0]


def known(base):
    return replace(base, calibrated=True)


@pytest.mark.slow
def test_a_bias_that_no_sensor_has_is_a_warning(exo, stance):
    """Such as a sole that is not level at zero angles, or a sensor that is mounted askew."""
    logs = [with_imu(log, k, force_bias=(0.9, 0.0, 0.0)) for k, log in enumerate(stance)]
    found = exoid.identify(exo, logs, terms=TERMS)
    (first, *_) = [finding for finding in found.findings if finding.kind == "imu-bias"]
    assert first.severity == "warning"
    assert "level at zero angles" in first.remedy
    assert {"M", "X1_left"} <= found.doubtful


def test_bands_of_the_torque_are_refused_by_name(estimate, stance):
    q, v, a = (part[:5] for part in stance[0].exact)
    base = stance[0].base.rows(slice(5))
    assert estimate.torque(q, v, a, base).shape == (5, 9)
    assert estimate.torque_band(q, v, a, base, measured=False).upper.shape == (5, 9)
    with pytest.raises(ExoidError, match="ground_forces"):
        estimate.torque_band(q, v, a, base)


REFUSED = {  # what is changed of the logs on both feet and on the left one, and words of the error
    "swing alone, which does not tell the mass": (lambda _, left: replace(left, contacts={}), "M"),
    "one foot alone, which leaves inertias together": (lambda both, left: [both, left], "J0"),
    "no such foot": (lambda _, left: replace(left, contacts={"lefft_foot": RIGHT["right_foot"]}), "lefft_foot"),
    "in the air": (
        lambda _, left: replace(left, contacts=AIR, wrenches={"left_foot": Wrench(*np.zeros((2, 3750, 3)))}),
        "motion of it",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_logs_that_do_not_tell_the_machine_are_refused(exo, stance, case):
    change, message = REFUSED[case]
    with pytest.raises(ExoidError, match=message):
        exoid.identify(exo, change(stance[0].recording, stance[1].recording), terms=TERMS)


@pytest.mark.parametrize("feet", ["both", "left"])
def test_validation_of_another_motion(exo, estimate, feet):
    log = standing(exo, feet, seconds=12.0, seed=97, noise=NOISE, encoder=ENCODER, friction=friction)
    found = exoid.validate(estimate, log.recording)
    assert (found.nrmse < 0.06).all()
    assert found.verdict == "predicts"


@pytest.mark.slow
def test_force_plates_belong_to_the_prediction_and_their_noise_to_the_band(exo, estimate):
    log = standing(exo, "both", seconds=20.0, seed=98, noise=NOISE, encoder=ENCODER, friction=friction)
    recording = with_plates(log, np.random.default_rng(0))
    found = exoid.validate(estimate, recording)
    logged = recording.tau[np.searchsorted(recording.time, found.time)]
    assert np.sqrt(np.mean((found.measured - logged) ** 2, axis=0)).max() < 1.5 * NOISE  # noise, and jumps of friction
    assert (found.coverage > 0.88).all()
    assert found.coverage.mean() == pytest.approx(0.95, abs=0.04)
    assert found.verdict == "predicts"


def strapped(exo, log, force=900.0):
    """Let the ground pull the left foot down by a force [N] more, and push the right one up."""
    q, count = log.recording.q, exo.base_rows
    left, right = (np.swapaxes(exo.contact_jacobian(q, foot), 1, 2) for foot in ("left_foot", "right_foot"))
    pull = left @ (0.0, -force, 0.0)
    other = np.linalg.solve(right[:, :count], -pull[:, :count, None])
    return replace(log.recording, tau=log.recording.tau - pull[:, count:] - (right[:, count:] @ other)[..., 0])


def turned(log):
    """Force plates whose axes are exchanged."""
    plates = {foot: Wrench(wrench.force[:, [2, 1, 0]], wrench.moment) for foot, wrench in log.wrenches.items()}
    return replace(log.recording, wrenches=plates)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda _, log: log.recording, []),
        (lambda _, log: replace(log.recording, wrenches=log.wrenches), []),
        (strapped, ["left_foot"]),
        (lambda _, log: turned(log), ["left_foot", "right_foot"]),
    ],
)
def test_feet_whose_force_no_ground_bears_are_named(exo, estimate, change, named):
    """Forces are eliminated, or known, so that the residual shows nothing."""
    log = change(exo, standing(exo, "both", seconds=8.0, seed=97, noise=NOISE, encoder=ENCODER, friction=friction))
    found = [*cone_findings(estimate, split(exo, log, estimate.preparation).stretches)]
    assert sorted(foot for each in found for foot in ("left_foot", "right_foot") if foot in each.message) == named


@pytest.mark.nightly
def test_checks_say_what_is_wrong_with_contacts(exo, stance):
    both, left, right = stance
    logs = [strapped(exo, both), wrongly(left, "right_foot", True, 1), right.recording]
    assert {"slipping-contact", "friction-cone"} <= {each.kind for each in exoid.check(exo, logs, terms=TERMS)}
    other = {"left_foot": "right_foot", "right_foot": "left_foot"}
    turned = [{other[link]: flags for link, flags in log.recording.contacts.items()} for log in stance]
    logs = [replace(log.recording, contacts=each) for log, each in zip(stance, turned, strict=True)]
    assert "impossible-leg" in {each.kind for each in exoid.check(exo, logs, terms=TERMS)}
    found = exoid.check(exo, [replace(log.recording, tau=10.0 * log.recording.tau) for log in stance], terms=TERMS)
    assert [round(each.value, 1) for each in found if each.kind == "torque-scale"] == [10.0]
    plain, knees = [0, 1, 2, 3, 4, 5], [1.0, -1.0, 1.0, 1.0, -1.0, 1.0]
    read = [
        ([0, 4, 2, 3, 1, 5], 1.0, "of left_knee and right_knee are swapped"),
        (plain, knees, "left_knee and right_"),
    ]
    for order, signs, said in (*read, ([3, 4, 5, 0, 1, 2], 1.0, "of left and right are interchanged")):
        mistaken = [replace(log.recording, tau=log.recording.tau[:, order] * signs) for log in stance]
        assert said in " ".join(
            one.message for one in exoid.check(exo, mistaken, terms=TERMS) if one.severity == "error"
        )
    up, rng, plates = RIGHT["left_foot"], np.random.default_rng(0), []
    for log, lifted in zip(stance, ({}, {"right_foot": up}, {"left_foot": up}), strict=True):
        one = with_plates(log, rng)
        larger = {link: replace(x, force=1.3 * x.force, moment=1.3 * x.moment) for link, x in one.wrenches.items()}
        plates.append(replace(one, wrenches=larger, contacts={**one.contacts, **lifted}))
    (found,) = (each for each in exoid.check(exo, plates, terms=TERMS) if each.severity != "info")
    assert (found.kind, found.value) == ("known-torque", pytest.approx(1.0 / 1.3, rel=0.02))
    with pytest.raises(ExoidError, match="N·mm"):
        exoid.identify(exo, replace(both.recording, tau=1e3 * both.recording.tau), TERMS)


@pytest.mark.slow
def test_a_known_payload_is_no_part_of_the_machine(exo):
    logs = session(exo, seconds=20.0, noise=0.1, encoder=2e-5, **CARRIED)
    found = identify(exo, [log.recording for log in logs], ())
    assert abs(found["M"].value - exo.parameters[0]) < 0.05
    assert np.sqrt(np.mean(deviations(exo, found) ** 2)) < 1.6


@pytest.mark.nightly  # test_standing_in_the_same_way.py has a late torque among the slow tests
def test_delays_are_looked_for_in_long_recordings(exo):
    """Rows of long recordings come in blocks, and those that are kept in one."""
    options = {"rate": 500.0, "noise": NOISE, "encoder": ENCODER, "friction": friction}
    late = []
    for k, (feet, seconds) in enumerate((("left", 36.0), ("both", 10.0), ("left", 10.0))):
        log = standing(exo, feet, seconds=seconds, seed=60 + k, **options)
        log = mirrored(log) if k == 2 else log
        base = BaseMotion(log.base.angular_velocity, log.base.specific_force, calibrated=True)
        late.append(replace(log.recording, base=base, tau=np.roll(log.recording.tau, 10, axis=0)))
    found = exoid.identify(exo, late, terms=TERMS, preparation=ZeroPhase(8.0, kinematics_cutoff=60.0))
    delays = [each.value for each in found.findings if each.kind == "torque-delay"]
    assert delays
    np.testing.assert_allclose(delays, 0.02, atol=0.002)


@pytest.mark.parametrize(("reads", "imu"), [(False, False), (False, True), (True, False), (True, True)])
def test_a_switch_that_never_changes_is_named(exo, stance, reads, imu):
    logs = [with_imu(log, 0) if imu else log.recording for log in stance]
    logs = [replace(log, contacts=AIR | log.contacts) for log in logs]
    refuse_dead_switches(exo, logs)
    for foot in AIR:
        dead = [replace(log, contacts={**log.contacts, foot: np.full(len(log), reads)}) for log in logs]
        with pytest.raises(ExoidError, match=f"the switch of {foot} reads {int(reads)} at all samples"):
            identify(exo, dead, TERMS)
