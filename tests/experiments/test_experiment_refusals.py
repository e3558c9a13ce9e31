"""What no experiment, plan or reference can do is refused before it runs: by its kind of error, which names it."""

import numpy as np
import pytest
from ground_machines import spatial_plant
from outcomes import refused

import exoid
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError
from exoid.experiments import (
    Bench,
    Harmonics,
    Hold,
    StaticProtocol,
    fit_harmonics,
    gait_for_leg,
    healthy_gait,
    run_static,
)
from exoid.experiments.bench import run_motion
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation, plan_stance
from exoid.experiments.ground import Stance, bleex_machine, single_support, squats_and_shifts
from exoid.experiments.ground.posture import planar_legs
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.leg.description import describe
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors, Wearer, simulate
from exoid.rig.ground import GroundPlant, Sole
from exoid.rig.ground.plant import BLEEX_SOLES

BLEEX, CUHK, EXO = exoid.load_leg("bleex"), exoid.load_leg("cuhk"), bleex_machine()
FLOATING, GAIT = exoid.load_exo("bleex", base="floating"), healthy_gait(0.8, 1.2)
OTHER = exoid.Leg.from_description(describe(FLOATING.description.plain, "other.urdf"), base="floating")
SLIDING = exoid.Leg.from_description(describe(CUHK.description.text.replace("revolute", "prismatic")), ("left_hip",))
UNDAMPED, DAMPED = ProportionalDerivative(400.0, 0.0), ProportionalDerivative(800.0, 60.0)
POSE = [[0.5, 0.5]]
TINY = {link: Sole.flat(-0.02, 0.02, -0.115) for link in BLEEX_SOLES}
ONE_JOINT = GroundPlant.build(exoid.load_exo("cuhk", base="floating"), {"left_shank": BLEEX_SOLES["left_foot"]})


def plan(limits=None, **options):
    """A plan within limits, given as keywords of MotionLimits.of."""
    limits = MotionLimits.of(CUHK, **limits) if limits else None
    return plan_excitation(CUHK, limits=limits, **{"duration": 10.0, "starts": 1, **options})


def stance(**options):
    return plan_stance(FLOATING, (), **({"noise": 0.4, "duration": 10.0} | options))


def bench(servo=DAMPED, control=500.0):
    return Bench(servo, IdealTorque(), Sensors(encoder_counts=np.inf), Rates(control, 50.0, 1e-3))


def static(poses=POSE, servo=DAMPED, leg=CUHK, **protocol):
    protocol = StaticProtocol(**{"travel": 1.0, "wait": 1.0, **protocol})
    return run_static(Plant.build(leg), np.array(poses), bench(servo), np.random.default_rng(0), protocol)


def follow(amplitude_deg=10.0, frequency=0.1, duration=10.0, joints=2, control=500.0):
    shape = (1, joints, 1)
    size, rate = np.full(shape, np.deg2rad(amplitude_deg)), np.full(shape, 2.0 * np.pi * frequency)
    motion = Harmonics(np.full(shape[1:], np.deg2rad(40.0)), size, rate, np.zeros(shape))
    return run_motion(Plant.build(CUHK), motion, bench(control=control), duration, np.random.default_rng(0))


def follow_exactly():
    """A log without torques."""
    time = np.arange(200) / 100.0
    return exoid.Recording(time, np.sin(np.outer(time, [1.0, 2.0])), joint_names=CUHK.joint_names)


def beyond_the_end_stops():
    hold = Hold(np.array([[0.5], [0.5]]))
    wearer = Wearer.build(CUHK, intention=healthy_gait(3.0, 1.2))
    return simulate(Plant.build(CUHK), hold, DAMPED, IdealTorque(), 1.0, wearer=wearer)


def arm():
    return exoid.Leg.from_urdf(exoid.catalog.urdf_folder() / "dfki_double_pendulum.urdf", ("shoulder", "elbow"))


def fit(count, *shape, last=4.0, period=5.0, value=0.0):
    return fit_harmonics(np.linspace(0.0, last, shape[0]), np.full(shape, value), period, count)


REFUSED = {
    BadArgumentError: [
        ("too short", lambda: plan(duration=2.0)),
        ("24 Hz", lambda: plan(rate=10.0)),
        ("best", lambda: plan(criterion="best")),
        ("c0_elbow", lambda: assess(CUHK, follow_exactly(), values={"c0_elbow": 1.0})),
        ("torque", lambda: plan({"torque": 5.0, "angles_deg": {"hip": (40, 50)}})),
        ("elbow", lambda: plan({"angles_deg": {"elbow": (0, 1)}})),
        ("left_knee: 90.0° to 20.0°", lambda: plan({"angles_deg": {"knee": (90, 20)}})),
        ("left_hip: 90.0 mm to 20.0 mm", lambda: MotionLimits.of(SLIDING, angles_deg={"hip": (90, 20)})),
        ("velocity", lambda: plan({"velocity": -1.0})),
        ("no recordings", lambda: assess(CUHK, [])),
        ("middle", lambda: stance(feet=("middle",))),
        ("left", lambda: stance(feet=("left", "left"))),
        ("centre of pressure", lambda: stance(soles=TINY)),
        ("torque", lambda: stance(limits=MotionLimits.of(FLOATING, torque=5.0))),
        ("3 samples", lambda: fit(3, 3, 1)),
        ("do not determine", lambda: fit(6, 100, 1, last=0.1, period=1.0)),
        ("no motion", lambda: fit(1, 5)),
        *(("period", lambda x=x: healthy_gait(period=x)) for x in (0.0, np.nan, "10")),
        ("amplitude", lambda: healthy_gait(np.nan)),
        ("left_knee", beyond_the_end_stops),
        ("left_ankle for 57.3", lambda: refuse_poses_beyond_limits(BLEEX, [[0.0, -0.1, 1.0]])),
        *(
            ("shape", lambda x=x: refuse_poses_beyond_limits(BLEEX, x))
            for x in ([[0.0, -0.1]], [0.0], np.zeros((0, 3)))
        ),
        ("a position of", lambda: follow(amplitude_deg=100.0)),
        ("a speed of", lambda: follow(20.0, 4.0, 1.0)),
        ("shape", lambda: follow(joints=3)),
        *(("duration", lambda x=x: follow(duration=x)) for x in (0.0, np.nan)),
        ("step", lambda: follow(control=333.0)),
        ("travel", lambda: StaticProtocol(travel=0.0)),
        ("left_hip", lambda: static([[3.0, 0.5]])),
        ("left_hip for 1500.0°/s", lambda: static(travel=0.01)),
        ("left_hip for 26179.9 mm/s", lambda: static([[0.5]], leg=SLIDING, travel=0.001)),
        ("wait", lambda: static(wait=0.1, readings=50)),
        ("rest", lambda: static(servo=UNDAMPED)),
        ("no leg 2", lambda: single_support(EXO, 1.0, standing=2)),
        ("a leg of 0.86 m", lambda: squats_and_shifts(EXO, 1.0, stance=Stance(height=1.0))),
        ("left_knee for -126.6", lambda: squats_and_shifts(EXO, 1.0, stance=Stance(height=0.5))),
        ("falls: at 5.", lambda: squats_and_shifts(EXO, 6.0, stance=Stance(frequency=1.6))),
        ("48.4 mm below the ground", lambda: single_support(EXO, 1.0, stance=Stance(height=0.75))),
        ("three", lambda: bleex_machine("three")),
        ("soles", lambda: plan_stance(OTHER)),
    ],
    NotSupportedError: [
        ("shoulder", lambda: gait_for_leg(arm(), GAIT)),
        ("knee, hip", lambda: gait_for_leg(CUHK, GAIT, {"left_hip": "knee", "left_knee": "hip"})),
        ("planar", lambda: planar_legs(spatial_plant())),
        ("one sole", lambda: squats_and_shifts(ONE_JOINT, 1.0)),
        ("one sole", lambda: stance(soles={"left_foot": BLEEX_SOLES["left_foot"]})),
        ("floating", lambda: plan_stance(BLEEX)),
    ],
    ExoidError: [  # what other rooms refuse
        ("floats", lambda: plan_excitation(FLOATING))
    ],
}


@pytest.mark.parametrize(("kind", "word", "call"), [(kind, *row) for kind, rows in REFUSED.items() for row in rows])
def test_it_is_refused_by_its_kind_and_named(kind, word, call):
    assert word in str(refused(kind, call))


def test_poses_and_motions_beyond_the_limits_are_refused_before_anything_runs(monkeypatch):
    for module in ("static", "bench"):
        monkeypatch.setattr(f"exoid.experiments.{module}.simulate", lambda *_, **__: pytest.fail("it ran"))
    for call in (lambda: static([[3.0, 0.5]]), lambda: static(travel=0.01), lambda: follow(amplitude_deg=100.0)):
        with pytest.raises(BadArgumentError):
            call()
