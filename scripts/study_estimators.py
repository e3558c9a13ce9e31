"""Which estimator when: angles with noise, joints that stick, and a real recording.

angles    A three-segment leg (BLEEX, CAD inertias, smooth friction) follows five harmonics of 0.1 Hz under PD control;
          of 20 s from the middle of the motion only angles and torques are known. Encoder noise of 1e-4 or 1e-3 rad at
          500 or 50 Hz, torque noise of 0.05 N·m, seeds from ``--first-seed`` on. Figure: mean relative error of the
          worst parameter (of 15) in percent; in brackets the share of 95 % intervals that contain the truth.
          ``--leg cuhk``: the two-segment leg, with the friction and gains of the first two joints, 10 parameters.
sticking  The same leg on the virtual rig with joints that truly stick, encoders of 2^16 counts, torque noise of
          0.05 N·m, a controller of 2 kHz and a log of 500 Hz. Figure: the same.
real      The DFKI double pendulum: identified on the training part; NRMSE of the torque on the test part.

    OMP_NUM_THREADS=1 python scripts/study_estimators.py                      # hours on one core
    OMP_NUM_THREADS=1 python scripts/study_estimators.py angles --estimators wls,ml --quantised --workers 4
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

import exoid
from exoid._typing import FloatArray
from exoid.experiments.references import Harmonics
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors, simulate
from exoid.signals import FiniteDifference

START, SECONDS, RATE = 2.137, 20.0, 500.0
TORQUE_NOISE = 0.05
COULOMB, VISCOUS = np.array([1.6, 1.2, 0.8]), np.array([1.0, 0.6, 0.4])
"""Assumed friction [N·m, N·m·s/rad]: with exact kinematics, the worst mean error of least squares is then 0.4 %."""
SMOOTHING = 0.02
STIFFNESS, DAMPING = np.array([600.0, 300.0, 60.0]), np.array([60.0, 30.0, 6.0])
"""Assumed gains [N·m/rad, N·m·s/rad]."""
TERMS = (exoid.Coulomb(smoothing=SMOOTHING, reversal_speed=0.0), exoid.Viscous())
STICKING_TERMS = (exoid.Coulomb(smoothing=0.0, dead_band=0.05), exoid.Viscous())
SETTINGS: Mapping[str, tuple[float, int]] = {
    "1e-4 rad, 500 Hz": (1e-4, 1),
    "1e-4 rad, 50 Hz": (1e-4, 10),
    "1e-3 rad, 500 Hz": (1e-3, 1),
    "1e-3 rad, 50 Hz": (1e-3, 10),
}
"""Standard deviation of the encoder noise [rad], and of how many 500 Hz samples one is kept."""
ESTIMATORS = ("exact", "ols", "wls", "huber", "ml")
"""exact: weighted least squares with the true angles, velocities and accelerations, unfiltered."""


class Motion(NamedTuple):
    """A tracked motion without noise, (N,) and (N, 3) each."""

    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    tau: FloatArray


class Outcome(NamedTuple):
    """Relative errors of one estimate, which of its 95 % intervals contain the truth, and its cost [s of CPU]."""

    errors: FloatArray
    inside: FloatArray
    seconds: float


@cache
def leg(name: str = "bleex") -> exoid.Leg:
    """BLEEX with the inertias of its CAD model, or the leg with two segments."""
    return exoid.load_leg(name)


def truth(name: str = "bleex") -> FloatArray:
    """Values that estimates should find, (15,) or (10,)."""
    n = len(leg(name).joint_names)
    return np.concatenate([leg(name).parameters, COULOMB[:n], VISCOUS[:n]])


def reference(n: int = 3) -> Harmonics:
    """Five harmonics of 0.1 Hz, for so many joints."""
    rng = np.random.default_rng(1)
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude = 0.42 * rng.uniform(0.4, 1.0, (3, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    amplitude, phase = amplitude[:n], phase[:n]
    return Harmonics(np.zeros((n, 1)), amplitude.T[..., None], np.asarray(omega[:, None, None]), phase.T[..., None])


@cache
def motion(name: str = "bleex") -> Motion:
    """Track the reference: Pinocchio's dynamics, integrated with an error of 1e-9 from rest on the reference on."""
    n = len(leg(name).joint_names)
    model, aim = leg(name).model, reference(n)
    data = model.createData()

    def torque(moment: float, state: FloatArray) -> FloatArray:
        target = aim.at(moment)
        return STIFFNESS[:n] * (target.q[:, 0] - state[:n]) + DAMPING[:n] * (target.v[:, 0] - state[n:])

    def rate(moment: float, state: FloatArray) -> FloatArray:
        v = state[n:]
        net = torque(moment, state) - COULOMB[:n] * np.tanh(v / SMOOTHING) - VISCOUS[:n] * v
        return np.concatenate([v, pin.aba(model, data, state[:n], v, net)])

    stamps = START + np.arange(round(SECONDS * RATE)) / RATE
    first = aim.at(0.0)
    begin = np.concatenate([first.q, first.v])[:, 0]
    solved = solve_ivp(rate, (0.0, stamps[-1] + 0.1), begin, "DOP853", stamps, rtol=1e-9, atol=1e-11, max_step=5e-3)
    states = solved.y.T
    a = np.array([rate(t, state)[n:] for t, state in zip(stamps, states, strict=True)])
    tau = np.array([torque(t, state) for t, state in zip(stamps, states, strict=True)])
    return Motion(stamps, states[:, :n], states[:, n:], a, tau)


def recording(
    setting: str, seed: int, *, quantised: bool, exact: bool = False, which: str = "bleex"
) -> exoid.Recording:
    """Log the motion: angles and torques only, unless ``exact``."""
    (noise, every), tracked = SETTINGS[setting], motion(which)
    rng = np.random.default_rng(seed)
    on_angles, on_torques = rng.standard_normal((2, *tracked.q.shape))
    count = np.sqrt(12.0) * noise  # a step of quantisation with the same standard deviation
    read = np.rint(tracked.q / count) * count if quantised else tracked.q + noise * on_angles
    tau = tracked.tau + TORQUE_NOISE * on_torques
    whole = exoid.Recording(tracked.time, read, tau=tau, joint_names=leg(which).joint_names)
    if exact:
        whole = replace(whole, q=tracked.q, v=tracked.v, a=tracked.a)
    return decimated(whole, every)


def decimated(whole: exoid.Recording, every: int) -> exoid.Recording:
    """Keep one of so many samples."""
    v, a, tau = (None if x is None else x[::every] for x in (whole.v, whole.a, whole.tau))
    return exoid.Recording(whole.time[::every], whole.q[::every], v, a, tau, joint_names=whole.joint_names)


def judge(identify: Callable[[], exoid.Estimate], expected: FloatArray) -> Outcome:
    """Identify and compare with the truth."""
    start = time.process_time()
    estimate = identify()
    seconds = time.process_time() - start
    low, high = estimate.interval().T
    return Outcome(np.abs(estimate.values / expected - 1.0), (low <= expected) & (expected <= high), seconds)


def replicate(seed: int, setting: str, name: str, quantised: bool, which: str = "bleex") -> Outcome:
    """Identify once from angles with noise."""
    exact, of = name == "exact", leg(which)
    log = recording(setting, seed, quantised=quantised, exact=exact, which=which)
    preparation = FiniteDifference() if exact else None
    chosen = "wls" if exact else name
    return judge(partial(exoid.identify, of, log, TERMS, chosen, preparation=preparation), truth(which))


def figure(outcomes: Sequence[Outcome]) -> str:
    """Mean error of the worst parameter and coverage, in percent."""
    errors, inside, _ = (np.mean(part, axis=0) for part in zip(*outcomes, strict=True))
    return f"{100.0 * errors.max():.2f} ({100.0 * inside.mean():.0f})"


def cost(outcomes: Sequence[Outcome]) -> str:
    """Least CPU time of an estimate [s]."""
    return f"{min(outcome.seconds for outcome in outcomes):.1f}"


def study_angles(names: Sequence[str], seeds: Sequence[int], quantised: bool, which: str, workers: int) -> None:
    """Print a row for each estimator."""
    print(f"| {'quantised' if quantised else 'noise'} | " + " | ".join(SETTINGS) + " | CPU s at 500 Hz |")
    print("|---" * (2 + len(SETTINGS)) + "|")
    motion(which)
    with ProcessPoolExecutor(workers) as pool:
        for name in names:
            cells: list[str] = []
            costs: list[str] = []
            for setting in SETTINGS:
                run = partial(replicate, setting=setting, name=name, quantised=quantised, which=which)
                outcomes = list(pool.map(run, seeds))
                cells.append(figure(outcomes))
                costs.append(cost(outcomes))
            print(f"| {name} | " + " | ".join([*cells, costs[0]]) + " |", flush=True)


def stick_slip(replicates: int, seed: int) -> list[exoid.Recording]:
    """Log rigs whose joints stick, all at once."""
    friction = [f"{symbol}_{label}" for symbol in ("c0", "d") for label in leg().joint_labels]
    values = dict(zip(friction, np.concatenate([COULOMB, VISCOUS]), strict=True))
    plant = Plant.build(leg(), values, end_stops=False).repeat(replicates)
    sensors = Sensors(torque_noise=TORQUE_NOISE)
    rates = Rates(control=2000.0, log=RATE)
    law = ProportionalDerivative(STIFFNESS, DAMPING)
    run = simulate(plant, reference(), law, IdealTorque(), 2.0 + SECONDS, sensors=sensors, rates=rates, seed=seed)
    return [run.recording(rig).slice(round(2.0 * RATE)) for rig in range(replicates)]


def stick_once(log: exoid.Recording, name: str) -> Outcome:
    """Identify once from a rig that sticks; samples at which it may are left out."""
    preparation = None if name == "ml" else "smoothed"
    return judge(partial(exoid.identify, leg(), log, STICKING_TERMS, name, preparation=preparation), truth())


def study_sticking(names: Sequence[str], replicates: int, seed: int, workers: int) -> None:
    """Print a row for each estimator."""
    logs = stick_slip(replicates, seed)
    print("| sticking | error % (coverage %) |\n|---|---|")
    with ProcessPoolExecutor(workers) as pool:
        for name in names:
            print(f"| {name} | {figure(list(pool.map(partial(stick_once, name=name), logs)))} |", flush=True)


def study_real(names: Sequence[str]) -> None:
    """Print a row for each estimator."""
    data = exoid.datasets.dfki_double_pendulum()
    print("| real | shoulder | elbow |\n|---|---|---|")
    for name in names:
        estimate = exoid.identify(data.leg, data.train, estimator=name)
        shoulder, elbow = exoid.validate(estimate, data.test).nrmse
        print(f"| {name} | {shoulder:.4f} | {elbow:.4f} |", flush=True)


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", default=["angles", "sticking", "real"], help="angles, sticking, real")
    parser.add_argument("--estimators", default=",".join(ESTIMATORS))
    parser.add_argument("--replicates", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=0, help="the rules of the estimators were set on 0 to 19")
    parser.add_argument("--leg", choices=["bleex", "cuhk"], default="bleex", help="of the noise in the angles")
    parser.add_argument("--quantised", action="store_true", help="encoders that round, in place of Gaussian noise")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    names = given.estimators.split(",")
    without = [name for name in names if name != "exact"]
    if "angles" in given.parts:
        seeds = range(given.first_seed, given.first_seed + given.replicates)
        study_angles(names, seeds, given.quantised, given.leg, given.workers)
    if "sticking" in given.parts:
        study_sticking(without, given.replicates, given.first_seed, given.workers)
    if "real" in given.parts:
        study_real(without)


if __name__ == "__main__":
    main()
