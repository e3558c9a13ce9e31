"""Plans of squats, shifts and leg swings: equation, gradient, limits, predicted precision, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from standing import mirrored, standing

import exoid
from exoid import BaseMotion, Coulomb, ExoidError, Viscous
from exoid.errors import NotSupportedError
from exoid.experiments.excitation import GroundLimits, MotionLimits, plan_stance, run_stance, search
from exoid.experiments.excitation.fourier import Basis
from exoid.experiments.excitation.objective import Stage
from exoid.experiments.excitation.plan_files import write_plan
from exoid.experiments.excitation.precision import predict
from exoid.experiments.excitation.scales import TorqueNoise
from exoid.experiments.excitation.stance.demands import LIMITS, Demands
from exoid.experiments.excitation.stance.objective import StanceObjective
from exoid.experiments.excitation.stance.support import StanceSupport, supports_of
from exoid.experiments.references import States
from exoid.rig.ground.plant import BLEEX_SOLES
from exoid.torques import DEFAULT_TERMS, TorqueModel
from exoid.torques.contacts.elimination import eliminate
from exoid.torques.contacts.standing_base import standing_base

EXO = exoid.load_exo("bleex", base="floating")
MODEL = TorqueModel(EXO, DEFAULT_TERMS)
COUNT = len(EXO.parameters)
EXPECTED = np.append(EXO.parameters, np.zeros(len(MODEL.names) - COUNT))
STD = (0.5, 0.4, 0.2) * 2
FEET = ("both", "left", "right")
HEEL, TOE, SOLE_HEIGHT = -0.075, 0.13, -0.115


def support(name) -> StanceSupport:
    return supports_of(EXO, (name,), BLEEX_SOLES)[0]


def demands(name, ground=None) -> Demands:
    return Demands(support(name), MODEL, EXPECTED, MotionLimits.of(EXO).torque, ground or GroundLimits())


def random_states(one, count=40, seed=0):
    return States(*np.random.default_rng(seed).uniform(-1.0, 1.0, (3, count, one.count)))


def quick_plan(feet, machine=EXO):
    """Slow motions without terms after a short search: limits and precision are as true as those of a long one."""
    with pytest.MonkeyPatch.context() as patch:
        *stages, last = (each._replace(iterations=8) for each in search.STAGES["worst"])
        patch.setitem(search.STAGES, "worst", (*stages, last._replace(iterations=30)))
        return plan_stance(machine, (), feet=feet, noise=STD, duration=10.0 * len(feet), highest=0.4, starts=1)


@pytest.fixture(scope="module")
def plan():
    return quick_plan(("left", "right"))


@pytest.mark.parametrize("name", FEET)
def test_what_a_foot_bears_is_that_of_the_contact_jacobian(name):
    one = support(name)
    joints = one.joints(random_states(one))
    rows = MODEL.columns(MODEL.motion(*joints, one.torso(joints).kinematics))
    found = one.ground_rows(joints, rows)
    J = EXO.contact_jacobian(joints.q, one.feet[0])[..., :3]
    wrench = np.linalg.solve(J.transpose(0, 2, 1), rows[:COUNT, :3].transpose(2, 1, 0)).transpose(2, 1, 0)
    np.testing.assert_allclose(found.wrench, wrench, atol=1e-11)
    np.testing.assert_allclose(found.torque, eliminate(EXO, one.feet[:1], joints.q).of(rows), atol=1e-11)


def test_forces_on_feet_side_by_side_do_no_work_along_the_coordinates():
    one = support("both")
    joints = one.joints(random_states(one))
    J = np.concatenate([EXO.contact_jacobian(joints.q, foot) for foot in one.feet], axis=1)
    lever = np.linalg.solve(J[:, :3, :3], J[:, :3, 3:] @ one.directions.T)
    moved = J[..., 3:] @ one.directions.T - J[..., :3] @ lever
    np.testing.assert_allclose(moved, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", FEET)
def test_soles_that_stand_rest_and_the_torso_moves_as_its_pose(name):
    one, rng = support(name), np.random.default_rng(1)
    basis = Basis.make(4.0, 4, 8000)
    joints = one.joints(basis.states(0.05 * rng.standard_normal((basis.count, one.count))))
    torso = one.torso(joints)
    for leg in one.stands:
        np.testing.assert_allclose(leg.points(torso.pose, joints.q).imag, 0.0, atol=1e-12)
    step = 4.0 / 8000
    change = np.diff(torso.pose, 2, axis=0) / step**2
    turn = np.exp(-1j * torso.pose[1:-1, 2]) * (change[:, 0] + 1j * (change[:, 1] + 9.81))
    force = torso.kinematics.specific_force[1:-1]
    np.testing.assert_allclose(force[:, [0, 2]], np.column_stack([turn.real, turn.imag]), atol=2e-4)
    np.testing.assert_allclose(-torso.kinematics.angular_acceleration[1:-1, 1], change[:, 2], atol=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("power", [0.0, 1.0, 16.0])
def test_the_gradient_is_that_of_finite_differences(power):
    tight = GroundLimits(doubt=0.1, bow_deg=5.0, clearance=0.3, friction=0.05, least_load=0.9, most_load=1.05)
    each = tuple(demands(name, tight) for name in FEET)
    basis, limits, scale = Basis.make(10.0, 4, 40), MotionLimits.of(EXO, torque=60.0), np.maximum(np.abs(EXPECTED), 0.5)
    each = tuple(replace(one, torque=limits.torque) for one in each)
    boxes = tuple(one.support.coordinate_limits(limits, 0.3) for one in each)
    common = {"basis": basis, "noise": TorqueNoise.of(STD, np.ones(6)), "seconds": 20.0, "rate": 100.0}
    known, pitches = np.eye(len(scale)), np.zeros(len(FEET))
    cost = StanceObjective(demands=each, limits=boxes, scale=scale, prior_information=known, pitches=pitches, **common)
    loose = replace(cost, demands=tuple(demands(name) for name in FEET))
    x = 3.0 * loose.draw(np.random.default_rng(2))
    assert all(cost.excesses_of(k, basis.states(part)).any() for k, part in enumerate(cost.coefficients(x)))
    stage = Stage(power, 30.0)
    _, gradient = cost(x, stage)
    for k in np.random.default_rng(3).integers(0, len(x), 12):
        step = 1e-6 * np.eye(len(x))[k]
        slope = (cost(x + step, stage)[0] - cost(x - step, stage)[0]) / 2e-6
        assert gradient[k] == pytest.approx(slope, rel=2e-3, abs=2e-4 * np.abs(gradient).max())


@pytest.mark.slow
def test_limits_hold_on_a_finer_grid(plan):
    """By inverse dynamics and the contact Jacobian, with the expected parameters."""
    limits, ground, weight = EXO.limits, GroundLimits(), 9.81 * EXO.parameters[0]
    for demand, motion in zip(plan.demands, plan.motions, strict=True):
        one = demand.support
        states = motion.period_samples(10000)
        joints = one.joints(states)
        torso = one.torso(joints)
        assert (joints.q >= limits.lower).all()
        assert (joints.q <= limits.upper).all()
        assert (np.abs(joints.v) <= limits.velocity).all()
        assert np.rad2deg(joints.q[:, [1, 4]].max()) <= -ground.knee_deg
        rows = EXO.inverse_dynamics(*joints, torso.kinematics)
        J = EXO.contact_jacobian(joints.q, one.feet[0])
        wrench = np.linalg.solve(J[..., :3].transpose(0, 2, 1), rows[:, :3, None])[..., 0]
        forward, up, moment = wrench.T
        torque = rows[:, 3:] - np.einsum("nki,nk->ni", J[..., 3:], wrench)
        pressure = (moment + SOLE_HEIGHT * forward) / up
        assert (np.abs(torque) <= limits.effort).all()
        assert (np.abs(forward) <= ground.friction * up).all()
        assert ground.least_load * weight <= up.min() <= up.max() <= ground.most_load * weight
        # the moment is about -y: forces in front of the ankle make it positive
        assert HEEL + ground.sole_margin <= pressure.min() <= pressure.max() <= TOE - ground.sole_margin
        assert one.swings[0].points(torso.pose, joints.q).imag.min() >= ground.clearance
        assert -ground.bow_deg <= np.rad2deg(torso.pose[:, 2].min())
        assert np.rad2deg(torso.pose[:, 2].max()) <= ground.recline_deg
        assert demand.at(states).margins.min() >= 0.0


@pytest.mark.slow
def test_margins_hold_for_parameters_within_the_doubt(plan):
    """Each parameter off by one standard deviation of the doubt, in random directions."""
    rng = np.random.default_rng(4)
    for demand, motion in zip(plan.demands, plan.motions, strict=True):
        states = motion.sampled(20.0)[1]
        for _ in range(10):
            off = demand.expected * (1.0 + demand.limits.doubt * rng.choice([-1.0, 1.0], len(demand.expected)))
            exact = replace(demand, expected=off, limits=replace(demand.limits, doubt=0.0))
            margins = exact.at(states).margins
            ground = np.isin(exact.kinds, [LIMITS.index(name) for name in ("friction", "centre of pressure")])
            assert (margins[ground].min(axis=1) > -0.02).all()


def with_imu(log):
    """The log with an exact IMU, which the prediction assumes."""
    foot = next(link for link, rests in log.contacts.items() if rests.all())
    base = standing_base(EXO, log, foot)
    return replace(log, base=BaseMotion(base.angular_velocity, base.specific_force))


def scatter(logs, model, seeds=8):
    """Errors of identifications of logs with noise of the torque, (S, P)."""
    errors, logs = [], [with_imu(log) for log in logs]
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        noisy = [replace(log, tau=log.tau + STD * rng.standard_normal(log.tau.shape)) for log in logs]
        found = exoid.identify(EXO, noisy, terms=model.terms)
        errors.append(found.values[:COUNT] - EXO.parameters)
    return np.array(errors)


def assert_scatter_is_predicted(errors, precision):
    """Root mean square of all, and of each kind of parameter; 8 seeds of one parameter scatter by a quarter alone."""
    relative = errors / precision.std[:COUNT]
    kinds = np.array([name[0] for name in EXO.parameter_names])
    for kind in "XYJ":
        assert np.sqrt(np.mean(relative[:, kinds == kind] ** 2)) == pytest.approx(1.0, abs=0.3)
    assert np.sqrt(np.mean(relative**2)) == pytest.approx(1.0, abs=0.2)


@pytest.mark.nightly
def test_the_predicted_precision_is_the_scatter_of_identifications(plan):
    assert_scatter_is_predicted(scatter(plan.recordings, plan.model), plan.precision)


@pytest.mark.nightly
def test_the_precision_of_any_stance_is_the_scatter_of_identifications(plan):
    """Staggered feet and other motions than planned ones, friction beside the rigid bodies."""
    model = TorqueModel(EXO, (Coulomb(smoothing=0.05), Viscous()))
    each = [standing(EXO, feet, seed=k, seconds=20.0) for k, feet in enumerate(("both", "left", "left"))]
    logs = [each[0].recording, each[1].recording, mirrored(each[2]).recording]
    scales = plan.precision.scales._replace(
        expected=EXPECTED[: len(model.names)], parameter_scale=np.ones(len(model.names))
    )
    precision = predict(model, logs, TorqueNoise(STD), scales)
    assert_scatter_is_predicted(scatter(logs, model), precision)


@pytest.mark.nightly
def test_planned_motions_beat_the_scenarios_of_the_rig():
    """Squats and shifts on both feet, and each leg swinging beside a hand rail, as long."""
    pytest.importorskip("mujoco")
    from exoid.experiments.ground import single_support, squats_and_shifts  # noqa: PLC0415
    from exoid.rig.ground import GroundPlant, GroundSensors  # noqa: PLC0415

    best = plan_stance(EXO, feet=FEET, noise=STD, starts=1)
    plant = GroundPlant.build(EXO, BLEEX_SOLES)
    runs = [squats_and_shifts(plant, 20.0, seed=1)]
    runs += [single_support(plant, 20.0, seed=2 + leg, standing=leg) for leg in (0, 1)]
    logs = [run.recording(GroundSensors.exact(), wrenches={*run.wrenches} - {*BLEEX_SOLES}) for run in runs]
    before = predict(best.model, logs, best.noise, best.precision.scales)
    assert before.worst > 1.6 * best.precision.worst


@pytest.mark.slow
def test_a_machine_follows_a_plan_on_flat_feet_and_is_identified(plan):
    """On one foot without a hand rail; an IMU tells how the torso moves on soles that give way a little."""
    pytest.importorskip("mujoco")
    from exoid.rig.ground import GroundSensors  # noqa: PLC0415

    logs = []
    for k, (one, run) in enumerate(zip(plan.supports, run_stance(plan, hand_rail=None), strict=True)):
        assert all(run.fixed(foot).all() for foot in one.feet)
        assert not any(run.feet[leg.foot].touching.any() for leg in one.swings)
        sensors = GroundSensors(torque_noise=STD[:3], angle_noise=1e-5)
        logs.append(run.recording(sensors, seed=k, wrenches=()))
    found = exoid.identify(EXO, logs, terms=())
    error = (found.values - EXO.parameters) / found.std
    assert np.sqrt(np.mean(error**2)) < 1.7
    assert found["M"].value == pytest.approx(EXO.parameters[0], rel=0.002)


@pytest.mark.slow
def test_two_feet_in_turn_determine_torso_and_legs(plan):
    assert plan.precision.identifiability == ("well",) * len(plan.model.names)
    assert plan.missing == ()
    assert "every parameter is determined well" in str(plan)


@pytest.mark.slow
def test_legs_of_unequal_size_are_planned_on_each_foot_alone():
    description = EXO.description
    hip = description.text.replace('xyz="0.0 -0.2 0.0"', 'xyz="0.05 -0.2 0.0"')  # the right hip, 5 cm in front
    uneven = exoid.Leg.from_description(replace(description, text=hip), base="floating")
    with pytest.raises(NotSupportedError) as refused:
        quick_plan(FEET, uneven)
    assert "left,right" in refused.value.remedy
    found = quick_plan(("left", "right"), uneven)
    assert found.precision.identifiability == ("well",) * len(found.model.names)


@pytest.mark.slow
def test_one_foot_names_what_cannot_be_told_apart():
    found = quick_plan(("left",))
    grades = dict(zip(found.precision.names, found.precision.identifiability, strict=True))
    loose = {name for name, grade in grades.items() if grade == "not"}
    assert {"J0", "J1_left", "J2_left", "M"} <= loose
    assert {"X0", "X1_right", "J1_right"}.isdisjoint(loose)
    assert "with motions on right as well: all of them can be determined" in str(found)
    with pytest.raises(ExoidError, match="J0"):
        exoid.identify(EXO, found.recordings, terms=())


@pytest.mark.slow
def test_files_have_contacts_and_are_identified(plan, tmp_path):
    files = write_plan(tmp_path / "squat.csv", plan)
    assert [file.name for file in files] == ["squat_left.csv", "squat_right.csv"]
    logs = [exoid.signals.Recording.from_csv(file) for file in files]
    assert logs[0].contacts["left_foot"].all()
    assert not logs[0].contacts["right_foot"].any()
    found = exoid.identify(EXO, logs, terms=())
    np.testing.assert_allclose(found.values, EXO.parameters, rtol=2e-3)


def test_a_machine_of_one_leg_stands_on_it():
    one = exoid.load_leg("bleex", base="floating")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(search.STAGES, "worst", tuple(each._replace(iterations=3) for each in search.STAGES["worst"]))
        found = plan_stance(one, (), feet=("left_foot",), noise=0.4, duration=10.0, highest=0.4, starts=1)
    grades = dict(zip(found.precision.names, found.precision.identifiability, strict=True))
    assert {"X0", "Y0"} <= {name for name, grade in grades.items() if grade != "not"}
    assert grades["J0"] == grades["M"] == "not"
    assert list(found.recordings[0].contacts) == ["left_foot"]
