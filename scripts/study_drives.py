"""What identification loses between the drive's sensor and the joint: cylinders of BLEEX, and a coupled wrist.

``cylinders``: the left leg of BLEEX on the virtual rig, with Coulomb and viscous friction, encoders of 2^16 counts and
noise of the torque sensors. The same runs are logged as joint torques and as forces of the three cylinders with assumed
attachment points. The table has, for each parameter, the error that 95 % of the seeds stay below, both ways, and their
ratio.

``offset``: the same force logs, read with an attachment point that is off by 10 mm: what ``exoid.check`` finds, how
large the parameter errors are, and how often it finds that where nothing is wrong.

``wrist``: a two-joint wrist behind a differential, with Coulomb and viscous friction of motors and joints, logged as
motor torques: errors of base parameters and friction in percent of the truth, and what is found if the coupling is
not described.

    OMP_NUM_THREADS=1 python scripts/study_drives.py cylinders --seeds 32
    OMP_NUM_THREADS=1 python scripts/study_drives.py offset --seeds 16
    OMP_NUM_THREADS=1 python scripts/study_drives.py wrist --seeds 8
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from functools import partial

import numpy as np
from smooth_stepper import CoupledMotors, SmoothStepper

import exoid
from exoid._typing import FloatArray
from exoid.actuators import Actuators, Coupling, read_actuators
from exoid.actuators.drive_data import actuators_from_data, actuators_to_data
from exoid.experiments import Harmonics
from exoid.leg.description import describe
from exoid.rig import (
    IdealTorque,
    Plant,
    ProportionalDerivative,
    Rates,
    Run,
    Sensors,
    simulate,
)
from exoid.tools.tables import make_table, to_text
from exoid.torques import TorqueModel

FRICTION = {"c0_hip": 1.2, "c0_knee": 0.9, "c0_ankle": 0.5, "d_hip": 0.5, "d_knee": 0.3, "d_ankle": 0.2}
"""[N·m], [N·m·s/rad]; assumed."""
TORQUE_NOISE = np.array([0.3, 0.2, 0.1])
"""Standard deviation at hip, knee and ankle [N·m]."""
CENTRE, AMPLITUDE = np.deg2rad([[45.0], [-55.0], [0.0]]), np.deg2rad([[28.0], [28.0], [22.0]])
STIFFNESS, DAMPING = np.array([[600.0], [300.0], [80.0]]), np.array([[30.0], [12.0], [2.0]])


def bleex_run(seeds: int, *, duration: float = 40.0, seed: int = 0) -> Run:
    """Let so many legs follow five harmonics of 0.15 Hz, each with phases and noise of its own."""
    leg = exoid.load_leg("bleex", inertias="identified")
    rng = np.random.default_rng(seed)
    size = np.array([1.0, 0.8, 0.6, 0.5, 0.4])[:, None, None] / 3.3
    shape = (5, 3, seeds)
    motion = Harmonics(
        np.tile(CENTRE, (1, seeds)),
        AMPLITUDE * size * np.ones(shape) * 1.3,
        2.0 * np.pi * 0.15 * np.arange(1.0, 6.0)[:, None, None] * np.ones(shape),
        rng.uniform(0.0, 2.0 * np.pi, shape),
    )
    plant = Plant.build(leg, FRICTION, end_stops=False).repeat(seeds)
    return simulate(
        plant,
        motion,
        ProportionalDerivative(STIFFNESS, DAMPING),
        IdealTorque(),
        duration,
        sensors=Sensors(encoder_counts=2.0**16, torque_noise=TORQUE_NOISE),
        rates=Rates(control=2000.0, log=100.0, step=5e-4),
        seed=seed,
        stepper=partial(SmoothStepper, smoothing=0.015),
    )


def truth(names: tuple[str, ...], leg: exoid.Leg) -> FloatArray:
    """True values by name; zero for what the rig does not have."""
    values = {**dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True)), **FRICTION}
    return np.array([values.get(name, 0.0) for name in names])


def force_log(run: Run, rig: int, drives: Actuators, seed: int) -> exoid.Recording:
    """Log the forces of cylinders: those of the true torques, with the noise of load cells.

    A load cell has white noise of its own: that of the torque sensor over the RMS moment arm.
    """
    log = run.recording(rig, actuators=drives)
    names = run.plant.leg.joint_names
    true = drives.readings(replace(log, q=run.q[..., rig], tau=run.tau[..., rig], force=None, joint_names=names))
    arms = np.array([drives.drives[name].moment_arm.arm(run.q[:, k, rig]) for k, name in enumerate(names)])
    noise = np.random.default_rng(1000 + seed).standard_normal(log.q.shape) * TORQUE_NOISE
    return replace(log, force=true.force + noise / np.sqrt(np.mean(arms**2, axis=1)))


def cylinder_errors(run: Run) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Errors of the estimates from joint torques and from cylinder forces.

    Args:
        run: Runs of so many seeds.

    Returns:
        Names of the parameters, and errors of both ways, (seeds, P) each.
    """
    leg, seeds = run.plant.leg, run.plant.count
    drives = read_actuators("bleex", leg)
    from_torque = [exoid.identify(leg, run.recording(k), check=False) for k in range(seeds)]
    from_force = [
        exoid.identify(leg, force_log(run, k, drives, k), check=False, actuators=drives) for k in range(seeds)
    ]
    names = from_torque[0].names
    errors = [np.array([each.values for each in way]) - truth(names, leg) for way in (from_torque, from_force)]
    return names, errors[0], errors[1]


def cylinders(seeds: int) -> None:
    """Print the errors both ways."""
    names, from_torque, from_force = cylinder_errors(bleex_run(seeds))
    most = [np.quantile(np.abs(errors), 0.95, axis=0) for errors in (from_torque, from_force)]
    sizes = [np.sqrt(np.mean(errors**2, axis=0)) for errors in (from_torque, from_force)]
    rows = [
        (name, f"{a:.4g}", f"{b:.4g}", f"{b / a:.2f}", f"{d / c:.2f}")
        for name, a, b, c, d in zip(names, *(each.tolist() for each in (*most, *sizes)), strict=True)
    ]
    headers = ("parameter", "P95 from torque", "P95 from force", "ratio", "ratio of RMS")
    print(to_text(make_table(headers, rows)))
    print(f"{seeds} seeds; geometric mean of the ratios of P95: {pooled_ratio(*most):.3f}")


def pooled_ratio(torque_p95: FloatArray, force_p95: FloatArray) -> float:
    """Geometric mean over the parameters of the ratio of P95 from force to that from torque."""
    return float(np.exp(np.mean(np.log(force_p95 / torque_p95))))


OFFSETS = [
    (joint, end, axis)
    for joint in ("left_hip", "left_knee", "left_ankle")
    for end in ("first", "second")
    for axis in "xz"
]
"""Point of each cylinder that is off in turn, by 10 mm, and the axis of its link along which it is."""


def displaced(drives: Actuators, joint: str, end: str, axis: str, size: float = 0.010) -> Actuators:
    """Describe the cylinders with an attachment point off at one joint."""
    data = actuators_to_data(drives)
    data[joint][end]["point"]["xyz".index(axis)] += size
    return actuators_from_data(data, exoid.load_leg("bleex", inertias="identified"))


def offset(seeds: int) -> None:
    """Print what is found where a point is off, and where none is."""
    run = bleex_run(seeds)
    leg = run.plant.leg
    drives = read_actuators("bleex", leg)
    logs = [force_log(run, k, drives, k) for k in range(seeds)]
    rigid, right = len(leg.parameter_names), exoid.identify(leg, logs[0], check=False, actuators=drives)
    rows = []
    for off in (None, *OFFSETS):
        joint = "" if off is None else off[0]
        described = drives if off is None else displaced(drives, *off)
        found = [exoid.check(leg, log, actuators=described) for log in logs]
        arms = [[f for f in each if f.kind == "moment-arm"] for each in found]
        there = [any(f.joint == joint for f in each) for each in arms]
        sizes = [1e3 * f.value for each in arms for f in each if f.joint == joint]
        others = {f"{f.kind} {f.joint}" for each in found for f in each if (f.kind, f.joint) != ("moment-arm", joint)}
        wrong = exoid.identify(leg, logs[0], check=False, actuators=described).values
        moved = np.abs(wrong - right.values)[:rigid] / (1.96 * right.std[:rigid])
        rows.append(
            (
                " ".join(off or ("none",)),
                f"{sum(there)}/{seeds}" if off else f"{sum(map(bool, arms))}/{seeds}",
                f"{min(sizes):.2g} … {max(sizes):.2g}" if sizes else "",
                f"{moved.max():.1f}",
                ", ".join(sorted(others)),
            )
        )
    headers = ("off by 10 mm", "moment-arm found", "size [mm]", "largest move [half widths]", "other findings")
    print(to_text(make_table(headers, rows)))


WRIST = """<robot name="wrist">
  <link name="forearm"/>
  <link name="cross"><inertial>
    <origin xyz="0.0 0.01 -0.05"/><mass value="0.8"/>
    <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.001"/>
  </inertial></link>
  <link name="hand"><inertial>
    <origin xyz="0.06 0.05 -0.14"/><mass value="1.6"/>
    <inertia ixx="0.012" ixy="0.0004" ixz="0.0006" iyy="0.013" iyz="-0.0005" izz="0.003"/>
  </inertial></link>
  <joint name="roll" type="revolute">
    <parent link="forearm"/><child link="cross"/><axis xyz="1 0 0"/>
    <limit lower="-1.5" upper="1.5" effort="20" velocity="8"/>
  </joint>
  <joint name="pitch" type="revolute">
    <parent link="cross"/><child link="hand"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="20" velocity="8"/>
  </joint>
</robot>
"""
DIFFERENTIAL = Coupling(("roll", "pitch"), ((0.05, 0.05), (0.05, -0.05)))
"""Two motors behind gears of ratio 10, and a differential."""
OF_JOINTS = {"c0_roll": 0.20, "c0_pitch": 0.12, "d_roll": 0.06, "d_pitch": 0.04}
OF_MOTORS = {"c0_roll_motor": 0.012, "c0_pitch_motor": 0.016, "d_roll_motor": 2e-4, "d_pitch_motor": 5e-4}
ROTORS = {"Ia_roll_motor": 2e-6, "Ia_pitch_motor": 1e-5}
"""Friction of joints and of motors, and rotors [N·m, N·m·s/rad, kg·m²]; assumed."""


WIDE, FAST = np.array([[0.8], [0.9]]), np.array([[0.24, 0.19, 0.095], [0.19, 0.17, 0.075]])
"""Amplitudes of roll and pitch [rad]: one slow harmonic over most of the range, and three fast ones,"""
SLOW_RATES, FAST_RATES = np.array([[0.17], [0.11]]), np.array([[1.2, 2.3, 3.4], [1.4, 2.6, 3.7]])
"""their frequencies [Hz]."""


def wrist_run(seed: int, *, duration: float = 120.0) -> Run:
    """Let the wrist swing widely and slowly, and shake fast, with friction of joints and motors.

    The rotors differ by 0.0008 kg·m² at the joints. That difference and Ixy of the hand couple the same accelerations,
    and only the angle of pitch tells one from the other: therefore the wide swing. Angles stay below 1.4 rad, speeds
    below 8 rad/s and torques below 9 N·m.
    """
    leg = exoid.Leg.from_description(describe(WRIST, "wrist"))
    rng = np.random.default_rng(seed)
    amplitude, rates = (np.hstack(pair).T[..., None] for pair in ((WIDE, FAST), (SLOW_RATES, FAST_RATES)))
    phase = rng.uniform(0.0, 2.0 * np.pi, amplitude.shape)
    motion = Harmonics(np.zeros((2, 1)), amplitude, 2.0 * np.pi * rates, phase)
    first, second = (
        [values[f"{symbol}_{joint}_motor"] for joint in ("roll", "pitch")]
        for symbol, values in (("c0", OF_MOTORS), ("d", OF_MOTORS))
    )
    motors = CoupledMotors(DIFFERENTIAL, coulomb=first, viscous=second, rotor=[*ROTORS.values()])
    return simulate(
        Plant.build(leg, OF_JOINTS, end_stops=False),
        motion,
        ProportionalDerivative(60.0, 3.0),
        IdealTorque(),
        duration,
        sensors=Sensors(encoder_counts=2.0**17, torque_noise=0.005),
        rates=Rates(control=2000.0, log=2000.0, step=5e-4),
        seed=seed,
        stepper=partial(SmoothStepper, motors=motors, smoothing=0.015),
    )


def wrist_log(run: Run, drives: Actuators) -> exoid.Recording:
    """Log angles and motor torques at 1 kHz.

    The drive reports the torque that it has just held for half a millisecond. What acts at a sample is therefore the
    mean of that torque and the next. Unshifted torques are 0.25 ms late, which is 3 % of the viscous friction of pitch.
    """
    log = run.recording(actuators=drives)
    assert log.motor_torque is not None
    held = 0.5 * (log.motor_torque[1:] + log.motor_torque[:-1])
    return exoid.Recording(log.time[:-1:2], log.q[:-1:2], motor_torque=held[::2], joint_names=log.joint_names)


def wrist_truth(model: TorqueModel) -> FloatArray:
    """True values of the parameters that remain, with the regrouped ones inside."""
    leg = model.leg
    every = {**dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True)), **OF_JOINTS, **OF_MOTORS, **ROTORS}
    values = {name: every.get(name, 0.0) for name in model.names}
    for regrouped in model.regrouped:
        for name, share in regrouped.into.items():
            values[name] += share * every.get(regrouped.name, 0.0)
    return np.array([values[name] for name in model.names])


def wrist(seeds: int) -> None:
    """Print errors with the coupling described, and findings without."""
    errors, found, clean = [], [], []
    for seed in range(seeds):
        run = wrist_run(seed)
        leg = run.plant.leg
        drives = Actuators.of(leg, {"wrist": DIFFERENTIAL})
        log = wrist_log(run, drives)
        estimate = exoid.identify(leg, log, check=False, actuators=drives)
        truth = wrist_truth(estimate.model)
        errors.append(estimate.values - truth)
        clean.append(exoid.check(leg, log, actuators=drives))
        found.append(exoid.check(leg, replace(log, tau=log.motor_torque, motor_torque=None)))
    most = np.quantile(np.abs(errors), 0.95, axis=0)
    scale = estimate.parameter_scale
    rows = [
        (
            name,
            f"{value:.4g}",
            f"{error:.2g}",
            f"{100.0 * error / abs(value):.2f}" if value else "",
            f"{error / size:.2g}",
        )
        for name, value, error, size in zip(estimate.names, truth, most, scale, strict=True)
    ]
    headers = ("parameter", "truth", "P95 of the error", "% of the truth", "% of the torque")
    print(to_text(make_table(headers, rows), *map(str, estimate.regrouped)))
    for name, each in (("described", clean), ("not described", found)):
        kinds = [f.kind for one in each for f in one]
        print(
            f"coupling {name}: "
            + (", ".join(f"{k} {kinds.count(k)}/{seeds}" for k in dict.fromkeys(kinds)) or "nothing")
        )


def main() -> None:
    """Run a study."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=("cylinders", "offset", "wrist"))
    parser.add_argument("--seeds", type=int, default=16)
    chosen = parser.parse_args()
    {"cylinders": cylinders, "offset": offset, "wrist": wrist}[chosen.study](chosen.seeds)


if __name__ == "__main__":
    main()
