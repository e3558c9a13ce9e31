"""How well do currents and one weighed payload give torque constants, efficiencies and the leg in N·m?

    python scripts/study_torque_constants.py              # all tables: some minutes on one core
    python scripts/study_torque_constants.py --masses     # only the second

The virtual rig is CUHK-EXO (Coulomb friction of 1.445 and 0.593 N·m with stiction) with motors: k_t = 0.070 and 0.050
N·m/A, ratio 50, efficiency 0.85 while the motor drives and 1 while it is driven, reflected rotor inertia 0.8 kg·m².
Each rig follows two multisines of its own, of 60 s each: one of the leg alone, one with a payload on the shank, 0.3 m
below the knee. The log has angles of a 16-bit encoder and currents with white noise of 0.15 A at 200 Hz, of 6 and 2 A
RMS. The current is that which makes the torque of the run behind the gear.

Of the motors only the ratio is given, and that their gears lose nothing while they are driven. The first table has the
95th percentile of the errors of 16 rigs, the mean error and the coverage of 95 % intervals of all rigs. The second has
the relative standard deviation of k_t for other payloads.
"""

from __future__ import annotations

import argparse
from functools import cache

import numpy as np

import exoid
from exoid._typing import FloatArray
from exoid.actuators import Motor
from exoid.experiments import Harmonics, cuhk
from exoid.experiments.bench import Bench, run_motion, stiff_servo
from exoid.leg.payload import Payload
from exoid.rig import IdealTorque, Plant, Rates, Run, Sensors, plant_with_payloads

KT, RATIO, EFFICIENCY = (0.070, 0.050), 50.0, 0.85
FRICTION = {"c0_hip": 1.445, "c0_knee": 0.593, "d_hip": 0.038, "d_knee": 0.192, "Ia_hip": 0.8, "Ia_knee": 0.8}
MASS, POSITION = 3.0, (0.0, 0.0, -0.30)
NOISE = 0.15
ENCODER = 2.0 * np.pi / 2.0**16
RATE, STRIDE = 1000.0, 5
"""Rate of the controller [Hz], of whose samples every fifth is in the log."""

RIGS, PERCENTILE_OF, SECONDS = 128, 16, 60.0
MASSES = (0.5, 1.0, 2.0, 3.0, 5.0)


@cache
def run(mass: float, seconds: float, rigs: int) -> Run:
    """Let rigs with a payload follow multisines, each one of its own."""
    leg = exoid.load_leg("cuhk")
    plant = Plant.build(leg, FRICTION, end_stops=False)
    if mass:
        plant = plant_with_payloads(plant, [Payload("knee", mass, POSITION)])
    bench = Bench(stiff_servo(plant), IdealTorque(), Sensors(encoder_counts=np.inf), Rates(control=RATE, log=RATE))
    seeds = [np.random.default_rng([rig, mass > 0.0]) for rig in range(rigs)]
    paths = Harmonics.concatenate([cuhk.multisine(leg, rng, draws=30) for rng in seeds])
    return run_motion(plant.repeat(rigs), paths, bench, seconds, np.random.default_rng(0))


def current_log(rig: int, mass: float, *, seconds: float, rigs: int) -> exoid.Recording:
    """Log angles and currents of one rig: the torque of the run behind a gear that loses power one way."""
    ran = run(mass, seconds, rigs)
    held, v = ran.tau[..., rig], ran.v[:-1:STRIDE, :, rig]
    tau = (0.5 * (held[1:] + held[:-1]))[::STRIDE]  # the torque is held before and after the sample
    current = tau / (RATIO * np.array(KT)) / np.where(tau * v > 0.0, EFFICIENCY, 1.0)
    rng = np.random.default_rng([rig, int(1000.0 * mass)])
    return exoid.Recording(
        ran.time[:-1:STRIDE],
        ENCODER * np.rint(ran.q[:-1:STRIDE, :, rig] / ENCODER),
        current=current + NOISE * rng.standard_normal(current.shape),
        joint_names=ran.plant.leg.joint_names,
        payloads=(Payload("knee", mass, POSITION),) if mass else (),
    )


def motors() -> dict[str, Motor]:
    """Motors of which only the ratio is known, and that their gears lose nothing while they are driven."""
    return {joint: Motor(None, RATIO, efficiency=None, back_efficiency=1.0) for joint in ("hip", "knee")}


def truth() -> dict[str, float]:
    """True parameters and constants; the rotor of the hip is part of J1."""
    leg = exoid.load_leg("cuhk")
    values = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True)) | FRICTION
    values["J1"] += values.pop("Ia_hip")
    constants = {"kt_hip": KT[0], "kt_knee": KT[1], "eta_hip": EFFICIENCY, "eta_knee": EFFICIENCY}
    return values | {"offset_hip": 0.0, "offset_knee": 0.0} | constants


def study(rigs: int, seconds: float) -> tuple[dict[str, FloatArray], FloatArray]:
    """Errors by name, relative unless the truth is zero, (rigs,), and whether intervals contain the truth."""
    leg, true = exoid.load_leg("cuhk"), truth()
    errors: dict[str, list[float]] = {name: [] for name in true}
    inside = []
    for rig in range(rigs):
        logs = [current_log(rig, mass, seconds=seconds, rigs=rigs) for mass in (0.0, MASS)]
        found = exoid.identify(leg, logs, actuators=motors(), check=False)
        for name, value in true.items():
            low, high = found[name].interval
            inside.append(low <= value <= high)
            errors[name].append((found[name].value - value) / (value or 1.0))
    return {name: np.array(of_one) for name, of_one in errors.items()}, np.reshape(inside, (rigs, -1))


def percentile(errors: FloatArray) -> float:
    """95th percentile of the absolute errors of the first rigs."""
    return float(np.quantile(np.abs(errors[:PERCENTILE_OF]), 0.95))


def print_study(rigs: int) -> None:
    """Print the first table."""
    errors, inside = study(rigs, SECONDS)
    print(f"| parameter | P95 of {PERCENTILE_OF} rigs | mean error of {rigs} | coverage |\n|---|---|---|---|")
    for (name, of_one), covered in zip(errors.items(), inside.mean(axis=0), strict=True):
        one, unit = (1.0, "N·m") if name.startswith("offset") else (100.0, "%")
        mean = one * of_one.mean()
        print(f"| {name} | {one * percentile(of_one):.2f} {unit} | {mean:+.2f} {unit} | {100 * covered:.0f} % |")
    print(f"\ncoverage of all intervals: {100 * inside.mean():.1f} %")


def print_masses() -> None:
    """Print the second table."""
    leg, rows = exoid.load_leg("cuhk"), []
    for mass in MASSES:
        logs = [current_log(0, each, seconds=SECONDS, rigs=1) for each in (0.0, mass)]
        found = exoid.identify(leg, logs, actuators=motors(), check=False)
        rows.append([100.0 * found[name].std / found[name].value for name in ("kt_hip", "kt_knee")])
    print("\n| payload [kg] | " + " | ".join(f"{mass:g}" for mass in MASSES) + " |\n|---|" + "---|" * len(MASSES))
    for joint, values in zip(("hip", "knee"), np.transpose(rows), strict=True):
        print(f"| standard deviation of kt_{joint} | " + " | ".join(f"{value:.2f} %" for value in values) + " |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--masses", action="store_true", help="only the second table")
    parser.add_argument("--rigs", type=int, default=RIGS, help="number of rigs")
    options = parser.parse_args()
    if not options.masses:
        print_study(options.rigs)
    print_masses()
