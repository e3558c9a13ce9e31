"""Data represent themselves in one line that says what they are, without their arrays."""

import numpy as np
import pytest
from rigs import BLEEX, FRICTION

import exoid
from exoid import Offset, TorsoMotion, Viscous
from exoid.experiments import Approach, Hold, bleex, healthy_gait
from exoid.experiments.excitation import MotionLimits
from exoid.rig import Plant
from exoid.signals import Approaches, FiniteDifference, Poses, Recording
from exoid.torques import TorqueModel

LEG = exoid.load_leg("cuhk")
MODEL = TorqueModel(BLEEX, (Viscous(joints=("knee",)), Offset(joints=("hip",))))
POSES = Poses(np.zeros((5000, 2)), np.ones((5000, 2)), ("hip", "knee"))
MOTION = Recording(time=np.arange(5000) / 100.0, q=POSES.q, joint_names=POSES.joint_names)
PLANTS = Plant.concatenate([Plant.build(BLEEX, FRICTION), Plant.build(BLEEX, {**FRICTION, "c0_hip": 3.0})])


@pytest.mark.parametrize(
    ("thing", "text"),
    [
        (LEG, "Leg('cuhk.urdf', joints=('left_hip', 'left_knee'), planar: X1, Y1, J1, X2, Y2, J2)"),
        (LEG.reduction, "Reduction(20 link parameters to 6: X1, Y1, J1, X2, Y2, J2)"),
        (LEG.description, f"Description(name='cuhk.urdf', sha256={LEG.description.sha256!r})"),
        (LEG.forward_kinematics(np.zeros((5000, 2))), "SegmentPlacements(5000 samples, 2 segments)"),
        (
            MODEL,
            "TorqueModel('bleex.urdf', terms: Viscous, Offset; X1, Y1, J1, X2, Y2, J2, X3, Y3, J3, d_knee, offset_hip)",
        ),
        (MODEL.motion(*np.zeros((3, 5000, 3))), "Motion(5000 samples, 3 joints, 0 internal states)"),
        (TorsoMotion(), "TorsoMotion()"),
        (TorsoMotion(0.25, hip_acceleration=(1.0, 0.0)), "TorsoMotion(pitch=0.25, hip_acceleration=[1.0, 0.0])"),
        (TorsoMotion(np.ones(5000)), "TorsoMotion(pitch=<array of shape (5000,)>)"),
        (POSES, "Poses(5000 poses; joints: hip, knee)"),
        (Approaches(POSES, POSES), f"Approaches(below={POSES!r}, above={POSES!r})"),
        (FiniteDifference().kinematics(MOTION), "Kinematics(5000 samples, 2 joints, valid: 1 to 4999)"),
        (PLANTS, "Plant(2 × bleex.urdf (left_hip, left_knee, left_ankle))"),
        (Hold(np.zeros((3, 1))), "Hold(3 joints, 1 rig)"),
        (Approach(np.zeros((2, 40)), np.ones((2, 40)), 4.0), "Approach(2 joints, 40 rigs in 4 s)"),
        (healthy_gait(period=10.0), "Harmonics(2 joints, 1 rig: 6 sinusoids up to 0.6 Hz)"),
        (
            bleex.static_sets(np.random.default_rng(0), 80),
            "StaticSets(ankle: 27 poses, knee: 23 poses, pairs: 42 poses, random: 80 poses)",
        ),
        (
            MotionLimits.of(LEG, margin=0.0, velocity=2.0, torque=(60.0, 25.0)),
            "MotionLimits(angle -30 to 110, -15 to 120 deg; velocity 2, 2 rad/s; acceleration inf, inf rad/s²; "
            "torque 60, 25 N·m)",
        ),
    ],
    ids=lambda x: type(x).__name__,
)
def test_data_represent_themselves_in_one_line(thing, text):
    assert repr(thing) == text


def test_a_plant_prints_the_range_of_each_quantity_over_its_rigs():
    rows = {line.split()[0]: line.split()[1:] for line in str(PLANTS).splitlines() if line.strip()}
    assert rows["left_hip"][:3] == ["2", "to", "3"]
    assert rows["left_knee"][0] == f"{FRICTION['c0_knee']:g}"
