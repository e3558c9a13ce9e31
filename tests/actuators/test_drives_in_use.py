"""Logs of currents and forces are identified, validated, checked, controlled and reported like logs of torques."""

from dataclasses import replace

import numpy as np
import pytest
from unchecked import identify

import exoid
from exoid.actuators import Actuators, Coupling, Motor, SeriesElastic, read_actuators, write_actuators
from exoid.signals import Recordings

DATA = exoid.datasets.bleex_swing()
LEG = DATA.leg
CYLINDERS = read_actuators("bleex", LEG)
MOTORS = Actuators.of(LEG, {joint: Motor(0.07, ratio=50.0) for joint in LEG.joint_names})


def log_of(drives, recording=DATA.train):
    """What the drives would have measured."""
    return drives.readings(recording)


@pytest.fixture(scope="module")
def by_torque():
    return identify(LEG, DATA.train)


@pytest.fixture(scope="module")
def by_force():
    return identify(LEG, log_of(CYLINDERS), actuators=CYLINDERS)


def test_forces_of_cylinders_give_the_estimate_of_torques(by_torque, by_force) -> None:
    """Document 1's chain: force and angle, moment arm, torque, identification."""
    assert log_of(CYLINDERS).tau is None
    np.testing.assert_allclose(by_force.values, by_torque.values, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    "drives", [{"hip": Motor(0.07, 50.0), "knee": Motor(0.05, 80.0, 0.8), "ankle": SeriesElastic(200.0, 60.0)}, MOTORS]
)
def test_motors_and_springs_give_the_estimate_of_torques(by_torque, drives) -> None:
    estimate = identify(LEG, log_of(Actuators.of(LEG, drives)), actuators=drives)
    np.testing.assert_allclose(estimate.values, by_torque.values, rtol=2e-2, atol=0.02)


def test_an_estimate_remembers_its_drives(tmp_path, by_force) -> None:
    path = tmp_path / "est.json"
    by_force.save(path)
    again = exoid.Estimate.load(path)
    assert dict(again.actuators.drives) == dict(CYLINDERS.drives)
    forces = log_of(CYLINDERS, DATA.test)
    np.testing.assert_allclose(
        exoid.validate(again, forces).nrmse, exoid.validate(by_force, DATA.test).nrmse, rtol=1e-9
    )
    assert "torque computed of drives: left_hip: linear, torso at (-0.17, 0.24, 0.3) m" in str(again)


def test_known_rotors_are_held_unless_the_caller_says_otherwise() -> None:
    drives = {joint: Motor(0.07, ratio=50.0, rotor_inertia=1e-5) for joint in LEG.joint_names}
    log = log_of(MOTORS)
    held = identify(LEG, log, actuators=drives)
    assert held["Ia_knee"].value == pytest.approx(0.025)
    assert held["Ia_hip"].value == pytest.approx(0.025), "no part of J1"
    assert held["Ia_knee"].std == 0.0
    other = identify(LEG, log, actuators=drives, known={"Ia_knee": 0.01})
    assert other["Ia_knee"].value == 0.01
    assert "Ia_knee" not in identify(LEG, log, (exoid.Viscous(),), actuators=drives).names


def test_torque_sensors_see_neither_rotors_nor_motors_of_couplings() -> None:
    """Drives that a log was not measured by change nothing."""
    rotors = {joint: Motor(0.07, ratio=50.0, rotor_inertia=1e-5) for joint in LEG.joint_names}
    coupled = {"both": Coupling(("hip", "knee"), ((1.0, 1.0), (1.0, -1.0)))}
    plain = identify(LEG, DATA.train)
    for drives in (rotors, coupled):
        estimate = identify(LEG, DATA.train, actuators=drives)
        assert estimate.names == plain.names
        np.testing.assert_array_equal(estimate.values, plain.values)


def test_checks_look_at_what_the_drive_measured() -> None:
    """A clipped force is no clipped torque, as the moment arm varies."""
    forces = log_of(CYLINDERS)
    assert forces.force is not None
    limit = float(np.quantile(np.abs(forces.force[:, 0]), 0.9))
    clipped = replace(forces, force=np.clip(forces.force, [-limit, -1e9, -1e9], [limit, 1e9, 1e9]))
    found = {(f.kind, f.joint, f.unit) for f in exoid.check(LEG, clipped, actuators=CYLINDERS)}
    assert ("saturation", "left_hip", "N") in found
    assert exoid.check(LEG, forces, actuators=CYLINDERS) == ()


def test_a_controller_commands_amperes_within_the_limits_of_its_motors(by_torque) -> None:
    limited = Actuators.of(LEG, {joint: Motor(0.07, ratio=50.0, max_current=2.0) for joint in LEG.joint_names})
    q, v = np.array([0.1, -0.3, 0.0]), np.zeros(3)
    target = exoid.rig.Target(np.array([0.11, -0.6, 0.0]), v)
    torque = exoid.control.pd(400.0, 10.0).torque(exoid.control.State(q, v), target)
    (commands,) = limited.command(torque, q, v)
    np.testing.assert_allclose(commands, [4.0 / 3.5, -2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(limited.torque_of(commands[None], q[None], v[None])[0], [4.0, -7.0, 0.0], atol=1e-12)


def test_the_rig_logs_what_drives_measure() -> None:
    plant = exoid.rig.Plant.build(LEG)
    hold = exoid.experiments.Hold(np.array([[0.5], [-0.7], [0.0]]))
    law = exoid.rig.ProportionalDerivative(400.0, 20.0)
    run = exoid.rig.simulate(plant, hold, law, exoid.rig.IdealTorque(), 0.5)
    log = run.recording(actuators=CYLINDERS)
    assert log.tau is None
    np.testing.assert_allclose(CYLINDERS.torque(log).tau, run.recording().tau, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_the_commands_identify_validate_and_check_logs_of_forces(exoid_, tmp_path) -> None:
    log_of(CYLINDERS).to_csv(tmp_path / "swing.csv")
    assert "f_left_hip" in (tmp_path / "swing.csv").read_text(encoding="utf-8").partition("\n")[0]
    options = ("--no-check", "--actuators", "bleex", "-o", "est.json", "--json")
    assert exoid_("identify", "bleex", "swing.csv", *options).data["actuators"]["left_hip"]["type"] == "linear"
    assert exoid_("validate", "est.json", "swing.csv").printed
    assert "Commands of the drives" in exoid_("track", "est.json", "--period", "2", "--scale", "0.3").printed
    write_actuators(CYLINDERS, tmp_path / "drives.toml")
    check = ("check", "bleex", "swing.csv", "--actuators", "drives.toml")
    assert "nothing found" in exoid_(*check).printed
    (tmp_path / "drives.toml").write_text('[left_hip]\ntype = "motor"\n', encoding="utf-8")
    assert "drives.toml, [left_hip]: no torque_constant" in exoid_(*check).refusal


def test_recordings_on_disk_get_their_torques_when_they_are_read(tmp_path, by_torque) -> None:
    log_of(CYLINDERS).to_csv(tmp_path / "log.csv")
    estimate = identify(LEG, Recordings.from_folder(tmp_path), actuators=CYLINDERS)
    np.testing.assert_allclose(estimate.values, by_torque.values, rtol=1e-6, atol=1e-9)
