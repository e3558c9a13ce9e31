"""Which estimator when: angles with noise, joints that stick, and a real recording.

angles    A three-segment leg (BLEEX, CAD inertias, smooth friction) follows five harmonics of 0.1 Hz under PD control;
          of 20 s from the middle of the motion only angles and torques are known. Encoder noise of 1e-4 or 1e-3 rad at
          500 or 50 Hz, torque noise of 0.05 N·m, seeds from 0 on. Figure: mean relative error of the worst of 15
          parameters in percent; in brackets the share of 95 % intervals that contain the truth.
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
from exoid.identification.estimators import ClosedLoop, Estimator, InstrumentalVariables, OutputError
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors, simulate
from exoid.signals import FiniteDifference

START, SECONDS, RATE = 2.137, 20.0, 500.0
TORQUE_NOISE = 0.05
COULOMB, VISCOUS = np.array([1.6, 1.2, 0.8]), np.array([1.0, 0.6, 0.4])
"""Assumed friction [N·m, N·m·s/rad]: with exact kinematics, the worst mean error of least squares is then 0.4 %."""
SMOOTHING = 0.02
STIFFNESS, DAMPING = np.array([600.0, 300.0, 60.0]), np.array([60.0, 30.0, 6.0])
"""Assumed gains [N·m/rad, N·m·s/rad]."""
TERMS = (exoid.Coulomb(smoothing=SMOOTHING), exoid.Viscous())
STICKING_TERMS = (exoid.Coulomb(smoothing=0.0, dead_band=0.05), exoid.Viscous())
SETTINGS: Mapping[str, tuple[float, int]] = {
    "1e-4 rad, 500 Hz": (1e-4, 1),
    "1e-4 rad, 50 Hz": (1e-4, 10),
    "1e-3 rad, 500 Hz": (1e-3, 1),
    "1e-3 rad, 50 Hz": (1e-3, 10),
}
"""Standard deviation of the encoder noise [rad], and of how many 500 Hz samples one is kept."""
ESTIMATORS = ("exact", "ols", "wls", "huber", "gls", "iv", "ml", "output-error")
"""exact: weighted least squares with the true angles, velocities and accelerations, unfiltered."""
NEED_LOOP = ("iv", "output-error")


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
def leg() -> exoid.Leg:
    """BLEEX with the inertias of its CAD model."""
    return exoid.load_leg("bleex", inertias="cad")


def truth() -> FloatArray:
    """Values that estimates should find, (15,)."""
    return np.concatenate([leg().parameters, COULOMB, VISCOUS])


def reference() -> Harmonics:
    """Five harmonics of 0.1 Hz."""
    rng = np.random.default_rng(1)
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude = 0.42 * rng.uniform(0.4, 1.0, (3, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    return Harmonics(np.zeros((3, 1)), amplitude.T[..., None], np.asarray(omega[:, None, None]), phase.T[..., None])


def loop(control_rate: float | None = None, step: float = 2e-3) -> ClosedLoop:
    """The loop of these experiments."""
    return ClosedLoop(ProportionalDerivative(STIFFNESS, DAMPING), reference(), IdealTorque(), control_rate, step)


@cache
def motion(seconds: float = SECONDS) -> Motion:
    """Track the reference: Pinocchio's dynamics, integrated with an error of 1e-9 from rest on the reference on."""
    model, aim = leg().model, reference()
    data = model.createData()

    def torque(moment: float, state: FloatArray) -> FloatArray:
        target = aim.at(moment)
        return STIFFNESS * (target.q[:, 0] - state[:3]) + DAMPING * (target.v[:, 0] - state[3:])

    def rate(moment: float, state: FloatArray) -> FloatArray:
        v = state[3:]
        net = torque(moment, state) - COULOMB * np.tanh(v / SMOOTHING) - VISCOUS * v
        return np.concatenate([v, pin.aba(model, data, state[:3], v, net)])

    stamps = START + np.arange(round(seconds * RATE)) / RATE
    first = aim.at(0.0)
    begin = np.concatenate([first.q, first.v])[:, 0]
    solved = solve_ivp(rate, (0.0, stamps[-1] + 0.1), begin, "DOP853", stamps, rtol=1e-9, atol=1e-11, max_step=5e-3)
    states = solved.y.T
    a = np.array([rate(t, state)[3:] for t, state in zip(stamps, states, strict=True)])
    tau = np.array([torque(t, state) for t, state in zip(stamps, states, strict=True)])
    return Motion(stamps, states[:, :3], states[:, 3:], a, tau)


def recording(setting: str, seed: int, *, quantised: bool, exact: bool = False) -> exoid.Recording:
    """Log the motion: angles and torques only, unless ``exact``."""
    (noise, every), tracked = SETTINGS[setting], motion()
    rng = np.random.default_rng(seed)
    on_angles, on_torques = rng.standard_normal((2, *tracked.q.shape))
    count = np.sqrt(12.0) * noise  # a step of quantisation with the same standard deviation
    read = np.rint(tracked.q / count) * count if quantised else tracked.q + noise * on_angles
    tau = tracked.tau + TORQUE_NOISE * on_torques
    whole = exoid.Recording(tracked.time, read, tau=tau, joint_names=leg().joint_names)
    if exact:
        whole = replace(whole, q=tracked.q, v=tracked.v, a=tracked.a)
    return thinned(whole, every)


def thinned(whole: exoid.Recording, every: int) -> exoid.Recording:
    """Keep one of so many samples."""
    v, a, tau = (None if x is None else x[::every] for x in (whole.v, whole.a, whole.tau))
    return exoid.Recording(whole.time[::every], whole.q[::every], v, a, tau, joint_names=whole.joint_names)


def estimator(name: str, closed: ClosedLoop) -> Estimator | str:
    """Estimator by name, with the loop where it needs one."""
    known: dict[str, Estimator | str] = {
        "iv": InstrumentalVariables(closed),
        "output-error": OutputError(closed),
        "exact": "wls",
    }
    return known.get(name, name)


def judge(identify: Callable[[], exoid.Estimate]) -> Outcome:
    """Identify and compare with the truth."""
    start = time.process_time()
    estimate = identify()
    seconds = time.process_time() - start
    low, high = estimate.interval().T
    return Outcome(np.abs(estimate.values / truth() - 1.0), (low <= truth()) & (truth() <= high), seconds)


def replicate(seed: int, setting: str, name: str, quantised: bool) -> Outcome:
    """Identify once from angles with noise."""
    exact = name == "exact"
    log = recording(setting, seed, quantised=quantised, exact=exact)
    preparation = FiniteDifference() if exact else None
    return judge(partial(exoid.identify, leg(), log, TERMS, estimator(name, loop()), preparation=preparation))


def figure(outcomes: Sequence[Outcome]) -> str:
    """Mean error of the worst parameter and coverage, in percent."""
    errors, inside, _ = (np.mean(part, axis=0) for part in zip(*outcomes, strict=True))
    return f"{100.0 * errors.max():.2f} ({100.0 * inside.mean():.0f})"


def cost(outcomes: Sequence[Outcome]) -> str:
    """Least CPU time of an estimate [s]."""
    return f"{min(outcome.seconds for outcome in outcomes):.1f}"


def study_angles(names: Sequence[str], replicates: int, quantised: bool, workers: int) -> None:
    """Print a row for each estimator."""
    print(f"| {'quantised' if quantised else 'noise'} | " + " | ".join(SETTINGS) + " | CPU s at 500 Hz |")
    print("|---" * (2 + len(SETTINGS)) + "|")
    motion()
    with ProcessPoolExecutor(workers) as pool:
        for name in names:
            cells: list[str] = []
            costs: list[str] = []
            for setting in SETTINGS:
                run = partial(replicate, setting=setting, name=name, quantised=quantised)
                outcomes = list(pool.map(run, range(replicates)))
                cells.append(figure(outcomes))
                costs.append(cost(outcomes))
            print(f"| {name} | " + " | ".join([*cells, costs[0]]) + " |", flush=True)


def stick_slip(replicates: int, seed: int = 0) -> list[exoid.Recording]:
    """Log rigs whose joints stick, all at once."""
    friction = [f"{symbol}_{label}" for symbol in ("c0", "d") for label in leg().joint_labels]
    values = dict(zip(friction, np.concatenate([COULOMB, VISCOUS]), strict=True))
    plant = Plant.build(leg(), values, end_stops=False).each(replicates)
    sensors = Sensors(torque_noise=TORQUE_NOISE)
    rates = Rates(control=2000.0, log=RATE)
    run = simulate(
        plant, reference(), loop().controller, IdealTorque(), 2.0 + SECONDS, sensors=sensors, rates=rates, seed=seed
    )
    return [run.recording(rig).slice(round(2.0 * RATE)) for rig in range(replicates)]


def stick_once(log: exoid.Recording, name: str) -> Outcome:
    """Identify once from a rig that sticks; only output error has a model of sticking, the others leave out."""
    closed, sticks = loop(2000.0, 5e-4), name == "output-error"
    terms = (exoid.Coulomb(smoothing=0.0), exoid.Viscous()) if sticks else STICKING_TERMS
    preparation = None if name in ("ml", *NEED_LOOP) else "smoothed"
    return judge(partial(exoid.identify, leg(), log, terms, estimator(name, closed), preparation=preparation))


def study_sticking(names: Sequence[str], replicates: int, workers: int) -> None:
    """Print a row for each estimator."""
    logs = stick_slip(replicates)
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
    parser.add_argument("--quantised", action="store_true", help="encoders that round, in place of Gaussian noise")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    names = given.estimators.split(",")
    without = [name for name in names if name != "exact"]
    if "angles" in given.parts:
        study_angles(names, given.replicates, given.quantised, given.workers)
    if "sticking" in given.parts:
        study_sticking(without, given.replicates, given.workers)
    if "real" in given.parts:
        study_real([name for name in without if name not in NEED_LOOP])


if __name__ == "__main__":
    main()
