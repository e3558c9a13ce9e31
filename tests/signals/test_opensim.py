"""Files of OpenSim: headers of every version, degrees, force plates, the pelvis, and what is refused."""

import numpy as np
import pinocchio as pin
import pytest
from log_writers import PLATE, plate, write_opensim

import exoid
from exoid import ExoidError, Recording
from exoid.leg.catalog import urdf_folder
from exoid.signals import Column, read_opensim, read_opensim_forces, wrenches_on_links

TIME = np.arange(200) / 100.0
ANGLE = 30.0 * np.sin(TIME)


def step(time):
    """Force, centre of pressure and free moment under a foot that stands from 0.4 s to 1.4 s, axes z up."""
    load = np.where((time > 0.4) & (time < 1.4), np.sin(np.pi * (time - 0.4)) ** 2, 0.0)
    force = np.column_stack([40.0 * load * np.sin(9.0 * time), -20.0 * load, 700.0 * load])
    point = np.column_stack([0.1 + 0.2 * time, 0.1 + 0.01 * np.sin(time), np.zeros_like(time)])
    return force, point, np.column_stack([np.zeros_like(time), np.zeros_like(time), 3.0 * load])


@pytest.mark.parametrize("name", ["walk.mot", "walk.sto", "WALK.MOT"])
@pytest.mark.parametrize("separator", ["\t", "   ", "\t "])
def test_angles_in_degrees_are_read_in_rad_and_translations_in_m(tmp_path, name, separator):
    columns = {"hip_flexion_r": ANGLE, "pelvis_tx": 0.4 + TIME, "hip_moment": ANGLE}
    write_opensim(tmp_path / name, TIME, columns, degrees=True, separator=separator)
    wanted = {"q_hip": "hip_flexion_r", "q_rail": "pelvis_tx", "tau_hip": "hip_moment"}
    recording = Recording.from_file(tmp_path / name, ("hip", "rail"), wanted)
    np.testing.assert_allclose(recording.q, np.column_stack([np.deg2rad(ANGLE), 0.4 + TIME]), rtol=1e-15)
    np.testing.assert_array_equal(recording.tau[:, 0], ANGLE)
    assert recording.source.name == name


@pytest.mark.parametrize(
    ("header", "degrees"),
    [
        (["version=1", "nRows=200", "nColumns=2", "inDegrees=yes"], True),
        (["nRows = 200", "nColumns = 2", "inDegrees = no"], False),
        (["nRows=200", "nColumns=2"], False),
        (["DataType=double", "version=3", "OpenSimVersion=4.4", "inDegrees=no"], False),
        (["datacolumns 2", "datarows 200", "range 0.0 1.99"], False),
        (["nRows=200", "nColumns=2", "", "# SIMM", "Angles are in degrees."], True),
        (["nRows=200", "datarows 200", "Angles are in degrees.", "inDegrees=yes"], True),
    ],
)
def test_headers_of_every_version_say_how_angles_are_read(tmp_path, header, degrees):
    write_opensim(tmp_path / "a.sto", TIME, {"knee": ANGLE / 30.0}, header=header)
    recording = Recording.from_file(tmp_path / "a.sto", columns={"q_knee": "knee"})
    expected = np.deg2rad(ANGLE / 30.0) if degrees else ANGLE / 30.0
    np.testing.assert_allclose(recording.q[:, 0], expected, rtol=1e-15)


@pytest.mark.parametrize(
    ("names", "key"),
    [
        (PLATE, "1"),
        (("ground_force_v", "ground_force_p", "ground_torque_"), "ground"),
        (("1_ground_force_v", "1_ground_force_p", "1_ground_torque_"), "1"),
        (("R_ground_force_v", "R_ground_force_p", "R_ground_torque_"), "R"),
        (("ground_force_calcn_r_v", "ground_force_calcn_r_p", "ground_force_calcn_r_m"), "calcn_r"),
        (("ground_force_2_v", "ground_force_2_p", "ground_moment_2_m"), "2"),
    ],
)
def test_names_of_force_columns_that_laboratories_use(tmp_path, names, key):
    force, point, moment = step(TIME)
    write_opensim(tmp_path / "grf.mot", TIME, plate(force, point, moment, names), degrees=True)
    forces = read_opensim_forces(tmp_path / "grf.mot")
    assert list(forces.wrenches) == [key]
    wrench = forces.wrenches[key]
    assert wrench.axes == "world"
    for found, true in ((wrench.force, force), (wrench.point, point), (wrench.moment, moment)):
        np.testing.assert_allclose(found, true, atol=1e-12)


def test_upward_in_opensim_is_upward_here_and_right_is_minus_left(tmp_path):
    ones = np.ones(len(TIME))
    columns = dict.fromkeys([f"{name}{axis}" for name in PLATE for axis in "xyz"], 0.0 * ones)
    columns |= {"ground_force_1_vy": 700.0 * ones, "ground_force_1_vz": 5.0 * ones, "ground_force_1_px": 0.3 * ones}
    columns |= {"ground_force_1_pz": 0.1 * ones, "ground_torque_1_y": 2.0 * ones}
    write_opensim(tmp_path / "grf.mot", TIME, columns)
    wrench = read_opensim_forces(tmp_path / "grf.mot").wrenches["1"]
    np.testing.assert_allclose(wrench.force[0], [0.0, -5.0, 700.0], atol=1e-12)
    np.testing.assert_allclose(wrench.point[0], [0.3, -0.1, 0.0], atol=1e-12)
    np.testing.assert_allclose(wrench.moment[0], [0.0, 0.0, 2.0], atol=1e-12)


def test_forces_are_brought_to_the_rate_of_the_motion(tmp_path):
    """1000 Hz onto 100 Hz: the wrench about the laboratory's origin is kept, though the point no longer moves."""
    fast = np.arange(2000) / 1000.0
    write_opensim(tmp_path / "grf.mot", fast, plate(*step(fast)))
    motion = Recording(TIME, np.deg2rad(ANGLE)[:, None], joint_names=("knee",))
    recording = read_opensim_forces(tmp_path / "grf.mot").attached_to(motion, {"1": "foot"})
    found = recording.wrenches["foot"].about((0.0, 0.0, 0.0))
    force, point, moment = step(TIME)
    np.testing.assert_allclose(found.force, force, atol=0.5)
    np.testing.assert_allclose(found.moment, moment + np.cross(point, force), atol=0.5)
    assert len(found) == len(recording)


def test_vibration_of_the_plate_does_not_alias(tmp_path):
    """490 Hz of 50 N, which samples at 100 Hz would show as 10 Hz."""
    fast = np.arange(2000) / 1000.0
    force, point, moment = step(fast)
    force[:, 2] += 50.0 * np.sin(2 * np.pi * 490.0 * fast)
    write_opensim(tmp_path / "grf.mot", fast, plate(force, point, moment))
    motion = Recording(TIME, np.deg2rad(ANGLE)[:, None], joint_names=("knee",))
    found = read_opensim_forces(tmp_path / "grf.mot").attached_to(motion, {"1": "foot"}).wrenches["foot"]
    assert np.abs(found.force[10:-10, 2] - step(TIME)[0][10:-10, 2]).max() < 1.0


def test_a_plate_without_a_force_needs_no_centre_of_pressure(tmp_path):
    force, point, moment = step(TIME)
    point[force[:, 2] == 0.0] = np.nan
    write_opensim(tmp_path / "grf.mot", TIME, plate(force, point, moment))
    wrench = read_opensim_forces(tmp_path / "grf.mot").wrenches["1"]
    loaded = force[:, 2] > 0.0
    np.testing.assert_allclose(wrench.point[loaded], point[loaded], atol=1e-12)
    point[np.flatnonzero(loaded)[0]] = np.nan
    write_opensim(tmp_path / "grf.mot", TIME, plate(force, point, moment))
    with pytest.raises(ExoidError, match=r"grf.mot, line \d+, column ground_force_1_px: nan is not"):
        read_opensim_forces(tmp_path / "grf.mot")


def test_kinematics_are_no_forces_and_millimetres_are_no_metres(tmp_path):
    write_opensim(tmp_path / "ik.mot", TIME, {"hip_flexion_r": ANGLE, "hip_flexion_r_moment": ANGLE})
    with pytest.raises(ExoidError, match=r"no ground reaction forces; the file has: time, hip_flexion_r"):
        read_opensim_forces(tmp_path / "ik.mot")
    force, point, moment = step(TIME)
    write_opensim(tmp_path / "mm.mot", TIME, plate(force, 1000.0 * point, moment))
    with pytest.raises(ExoidError, match=r"mm.mot.*the point of a wrench is .* m from the origin"):
        read_opensim_forces(tmp_path / "mm.mot")


def test_forces_must_cover_the_motion_and_name_plates_and_links(tmp_path):
    write_opensim(tmp_path / "grf.mot", TIME, plate(*step(TIME)))
    forces = read_opensim_forces(tmp_path / "grf.mot")
    motion = Recording(TIME + 0.5, np.deg2rad(ANGLE)[:, None], joint_names=("knee",))
    with pytest.raises(ExoidError, match=r"forces from 0 s to 1.99 s do not cover the recording, from 0.5 s to 2.49 s"):
        forces.attached_to(motion, {"1": "foot"})
    covered = motion.between(0.5, 1.9)
    with pytest.raises(ExoidError, match=r"no plate '2'.*plates of the file are 1"):
        forces.attached_to(covered, {"2": "foot"})
    both = forces.attached_to(covered, {"1": "foot"})
    with pytest.raises(ExoidError, match=r"a link has two wrenches: foot"):
        forces.attached_to(both, {"1": "foot"})


def pelvis_columns(tilt=0.0, list_=0.0, rotation=0.0, place=(0.0, 0.9, 0.0)):
    """Coordinates of a pelvis that stands still, in degrees and m."""
    ones = np.ones(len(TIME))
    names = ("pelvis_tilt", "pelvis_list", "pelvis_rotation", "pelvis_tx", "pelvis_ty", "pelvis_tz")
    return {name: value * ones for name, value in zip(names, (tilt, list_, rotation, *place), strict=True)}


def pelvis_of(path, columns):
    """Pose of the pelvis in a file of these columns."""
    write_opensim(path, TIME, {"knee": ANGLE, **columns}, degrees=True)
    return read_opensim(path, {"q_knee": "knee"}).base.pose


@pytest.mark.parametrize(
    ("angles", "axis", "direction"),
    [
        ({"tilt": 30.0}, 0, [np.cos(np.pi / 6), 0.0, 0.5]),  # tilt: the front rises
        ({"list_": 30.0}, 2, [0.0, -0.5, np.cos(np.pi / 6)]),  # list: the top falls to the right
        ({"rotation": 30.0}, 0, [np.cos(np.pi / 6), 0.5, 0.0]),  # rotation: the front turns to the left
    ],
)
def test_each_angle_of_the_pelvis_turns_it_as_in_opensim(tmp_path, angles, axis, direction):
    pose = pelvis_of(tmp_path / "ik.mot", pelvis_columns(**angles))
    np.testing.assert_allclose(pose.position[0], [0.0, 0.0, 0.9], atol=1e-12)
    turn = pin.Quaternion(*pose.quaternion[0][[3, 0, 1, 2]]).toRotationMatrix()
    np.testing.assert_allclose(turn[:, axis], direction, atol=1e-12)


def test_a_trial_has_angles_the_motion_of_the_pelvis_and_wrenches(tmp_path):
    fast = np.arange(2000) / 1000.0
    rate = np.deg2rad(20.0)
    pelvis = pelvis_columns(place=(0.3, 0.9, 0.1)) | {"pelvis_rotation": 20.0 * TIME}
    write_opensim(tmp_path / "ik.mot", TIME, {"knee_angle_r": ANGLE, **pelvis}, degrees=True)
    write_opensim(tmp_path / "grf.mot", fast, plate(*step(fast)), degrees=True)
    recording = read_opensim(
        tmp_path / "ik.mot", {"q_knee": "knee_angle_r"}, forces=tmp_path / "grf.mot", links={"1": "right_foot"}
    )
    np.testing.assert_allclose(recording.q[:, 0], np.deg2rad(ANGLE), rtol=1e-13)
    np.testing.assert_allclose(recording.base.angular_velocity, np.tile([0.0, 0.0, rate], (200, 1)), atol=1e-9)
    np.testing.assert_allclose(recording.base.specific_force, np.tile([0.0, 0.0, 9.81], (200, 1)), atol=1e-6)
    np.testing.assert_allclose(recording.base.pose.position, np.tile([0.3, -0.1, 0.9], (200, 1)), atol=1e-9)
    assert recording.wrenches["right_foot"].axes == "world"
    columns = {"q_knee": "knee_angle_r", "time": Column("time", zero=0.5)}  # one clock, for all files
    later = read_opensim(tmp_path / "ik.mot", columns, forces=tmp_path / "grf.mot", links={"1": "right_foot"})
    np.testing.assert_allclose(later.base.pose.columns, recording.base.pose.columns, atol=1e-12)
    for one, other in zip(later.wrenches.values(), recording.wrenches.values(), strict=True):
        np.testing.assert_allclose(one.columns, other.columns, atol=1e-6)
    still = read_opensim(tmp_path / "ik.mot", {"q_knee": "knee_angle_r"}, pelvis=False)
    assert still.base is None


def test_each_file_of_a_trial_says_the_unit_of_its_angles(tmp_path):
    """Accelerations in rad/s² beside angles in degrees were 57 times too small, in silence."""
    write_opensim(tmp_path / "ik.mot", TIME, {"knee": ANGLE}, degrees=True)
    write_opensim(tmp_path / "acc.sto", TIME, {"knee_acc": ANGLE})
    for first, other in (("ik.mot", "acc.sto"), ("acc.sto", "ik.mot")):
        columns = {"q_knee": "knee", "a_knee": "knee_acc"}
        log = Recording.from_file(tmp_path / first, columns=columns, beside=[tmp_path / other])
        np.testing.assert_allclose(np.hstack([log.q, log.a]), np.column_stack([np.deg2rad(ANGLE), ANGLE]), rtol=1e-12)


def test_ground_forces_reach_the_foot_through_pelvis_and_joints(tmp_path):
    """The wrench in axes of the foot, by Pinocchio with a free-flying root at the pose of the pelvis."""
    leg = exoid.load_leg("bleex", side="left")
    tilt, list_, rotation, angles = 12.0, -7.0, 25.0, (20.0, -35.0, 8.0)
    ones = np.ones(len(TIME))
    joints = {f"angle_{name}": angle * ones for name, angle in zip(leg.joint_names, angles, strict=True)}
    pelvis = pelvis_columns(tilt, list_, rotation, (0.4, 0.95, -0.2))
    write_opensim(tmp_path / "ik.mot", TIME, joints | pelvis, degrees=True)
    force, point, moment = step(TIME)
    write_opensim(tmp_path / "grf.mot", TIME, plate(force, point, moment), degrees=True)
    columns = {f"q_{name}": f"angle_{name}" for name in leg.joint_names}
    link = "left_foot"
    recording = read_opensim(tmp_path / "ik.mot", columns, forces=tmp_path / "grf.mot", links={"1": link})
    found = wrenches_on_links(leg, recording)[link]

    model = pin.buildModelFromUrdf(str(urdf_folder() / "bleex.urdf"), pin.JointModelFreeFlyer())
    q, up = pin.neutral(model), pin.utils.rotate("x", np.pi / 2)
    turn = np.deg2rad([tilt, list_, rotation])
    opensim = pin.utils.rotate("z", turn[0]) @ pin.utils.rotate("x", turn[1]) @ pin.utils.rotate("y", turn[2])
    q[:7] = pin.SE3ToXYZQUAT(pin.SE3(up @ opensim @ up.T, np.array([0.4, 0.2, 0.95])))
    for name, angle in zip(leg.joint_names, np.deg2rad(angles), strict=True):
        q[model.joints[model.getJointId(name)].idx_q] = angle
    state = model.createData()
    pin.framesForwardKinematics(model, state, q)
    foot = state.oMf[model.getFrameId(link)]
    for k in range(0, len(TIME), 13):
        at_origin = pin.Force(force[k], moment[k] + np.cross(point[k], force[k]))
        expected = foot.actInv(at_origin)
        one = found.about((0.0, 0.0, 0.0))
        np.testing.assert_allclose(one.force[k], expected.linear, atol=1e-6)
        np.testing.assert_allclose(one.moment[k], expected.angular, atol=1e-6)


def test_a_trial_says_what_is_missing(tmp_path):
    write_opensim(tmp_path / "ik.mot", TIME, {"knee": ANGLE}, degrees=True)
    with pytest.raises(ExoidError, match=r"forces and links belong together"):
        read_opensim(tmp_path / "ik.mot", {"q_knee": "knee"}, forces=tmp_path / "grf.mot")
    columns = pelvis_columns() | {"knee": ANGLE}
    columns["pelvis_tx"] = np.where(TIME > 1.0, 900.0, 0.0)
    write_opensim(tmp_path / "mm.mot", TIME, columns, degrees=True)
    with pytest.raises(ExoidError, match=r"mm.mot.*position of the base jumps"):
        read_opensim(tmp_path / "mm.mot", {"q_knee": "knee"})


def test_a_repeated_stamp_and_a_gap_are_refused_with_their_line_or_split(tmp_path):
    """One stamp twice and 0.3 s missing: the pelvis is as without, but for the gap."""
    columns = pelvis_columns(tilt=10.0 * np.sin(3.0 * TIME))
    rows = np.r_[0:50, 49, 50:120, 150:200]
    whole = pelvis_of(tmp_path / "whole.mot", columns)
    columns["knee"] = ANGLE
    for name, kept, words in (
        ("twice.mot", np.r_[0:50, 49, 50:200], r"twice.mot, line \d+: time is repeated: 0.49 s"),
        ("gap.mot", np.r_[0:120, 150:200], r"gap.mot, line \d+: a gap of 0.31 s"),
        ("both.mot", rows, r"both.mot, line \d+: time is repeated"),
    ):
        write_opensim(tmp_path / name, TIME[kept], {key: x[kept] for key, x in columns.items()}, degrees=True)
        with pytest.raises(ExoidError, match=words):
            read_opensim(tmp_path / name, {"q_knee": "knee"})
        recording = read_opensim(tmp_path / name, {"q_knee": "knee"}, gaps="split")
        np.testing.assert_allclose(recording.time, TIME, atol=1e-9)
        counted = np.ones(len(TIME), dtype=bool) if recording.mask is None else recording.mask
        np.testing.assert_allclose(recording.base.pose.quaternion[counted], whole.quaternion[counted], atol=1e-6)
        assert recording.mask is None or not recording.mask[100:170].any()
        assert len(recording.base) == len(recording) == 200
