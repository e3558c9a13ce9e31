"""Are contacts told, functions coordinated, and toes cleared as stated? Figures of docs/coordination.md.

    python scripts/study_coordination.py      # 2 seeds each of BLEEX and CUHK-EXO, ten minutes
    python scripts/study_coordination.py --machines cuhk --seeds 1 --seconds 60
    python scripts/study_coordination.py --toe --machines bleex     # toe clearance alone: 400 swings, a minute
    python scripts/study_coordination.py --frozen --machines bleex --seeds 1    # frozen encoders alone

Each seed is one `exoid coordinate`: other calibration, motions, noise and faults. Toe clearance: the estimate of a
swinging leg is fixed, true legs are drawn from its distribution, and each swings once under computed torque.
"""

from __future__ import annotations

import argparse
import warnings

import numpy as np
import scipy

from exoid import identify, load_leg
from exoid.control.functions import PHASE, Body, walk
from exoid.control.ground.hypotheses import CERTAIN, ContactFilter
from exoid.control.toe_clearance import toe_clearance
from exoid.lab.coordination import coordinate, coordination_report, study
from exoid.lab.coordination.day import MACHINES, run_function
from exoid.rig.ground.plant import BLEEX_SOLES, CUHK_SOLES
from exoid.signals import Recording
from exoid.torques import Armature, Coulomb, Viscous
from exoid.torques.model import TorqueModel

KP, KD = 400.0, 40.0
START, HIP = 0.01, 0.002
"""Standard deviations of the angles at lift-off [rad] and of the height of the hip [m], assumptions."""


def toe(machine: str, seed: int, swings: int) -> dict[str, float]:
    """State the least clearance, and count the drawn legs that keep it."""
    rng, leg = np.random.default_rng(seed), load_leg(machine)
    body = _body(machine)
    function = walk(body, period=1.2)
    swing = np.array(["left" not in function.expected(p) for p in PHASE])
    phase = PHASE[swing]
    time = np.arange(0.0, (phase[-1] - phase[0]) * function.duration, 2e-3)
    at = phase[0] + time / function.duration
    curve = scipy.interpolate.CubicSpline(PHASE, function.flexion[:, 0])
    n = len(leg.joint_names)
    sign = np.array([1.0, -1.0, 1.0])[:n] * leg.chain.signs
    q = curve(at)[:, :n] * sign
    torso = scipy.interpolate.CubicSpline(PHASE, function.torso)(at)
    hip = torso[:, 0] + 1j * torso[:, 1]

    def height(angles):  # noqa: ANN001, ANN202
        flexion = np.zeros((len(angles), 3))
        flexion[:, :n] = angles * sign
        return body.sole(hip, torso[:, 2], flexion).imag.min(axis=1)

    estimate = _estimate(leg, rng)
    # what is left of the swing once the foot is off: its ends are on the ground by plan
    inner = slice(round(0.15 * len(time)), round(0.85 * len(time)))
    ground = np.zeros(len(time))
    ground[: inner.start], ground[inner.stop :] = -1.0, -1.0
    stated = toe_clearance(
        estimate, time, q, lambda x: height(x) - ground, kp=KP, kd=KD, start_std=START, carried_std=HIP, seed=seed
    )
    least = _swings(estimate, time, q, lambda x: height(x) - ground, rng, swings)
    return {
        "planned [mm]": 1e3 * float(stated.planned.min()),
        "stated, 95 % [mm]": 1e3 * stated.least,
        "kept [%]": 100.0 * float(np.mean(least >= stated.least)),
        "stated to touch [%]": 100.0 * stated.touches,
        "touched [%]": 100.0 * float(np.mean(least < 0.0)),
    }


def frozen(machine: str, seed: int) -> dict[str, int]:
    """Freeze each encoder twice while sitting, rising, walking and climbing, and count certain sets that are wrong."""
    plant, rng = MACHINES[machine](), np.random.default_rng([seed, 1])
    model = TorqueModel(plant.leg, study.TERMS)
    values = np.array([plant.values[name] for name in model.names])
    out = dict.fromkeys(("certain", "of them wrong", "certain while slow", "of those wrong"), 0)
    for number, name in enumerate(("sit", "rise", "walk", "stairs up")):
        episode = run_function(plant, name, 6.0, rng)
        run, noise = episode.run, np.random.default_rng([seed, number, 300])
        log = run.recording(study.SENSORS, noise, wrenches=(run.plant.root_link,))
        told = ContactFilter(
            model, values, np.diag((0.01 * values) ** 2), run.plant.soles, np.array(study.SENSORS.imu_position), 500.0
        )
        readings, ends = study.readings_of(told, log, {}), study._blocks(told, len(log))
        slow = np.abs(run.v[ends]).max(axis=1) < told.noise.moves
        for joint in range(log.n_joints):
            for begin in rng.integers(len(log) // 6, 2 * len(log) // 3, 2):
                q = readings.q.copy()
                q[begin:, joint] = q[begin, joint]
                belief = told.advance(told.begin(), readings._replace(q=q))
                right, far = study._judge(told, episode, belief)
                sure = (belief.probability[:, :-1].max(axis=1) > CERTAIN) & (ends >= begin + 15) & far
                counts = (sure, sure & ~right, sure & slow, sure & slow & ~right)
                out = {key: out[key] + int(count.sum()) for key, count in zip(out, counts, strict=True)}
    return out


def _body(machine: str) -> Body:
    from exoid import load_exo  # noqa: PLC0415

    return Body.of(load_exo(machine, base="floating"), {"bleex": BLEEX_SOLES, "cuhk": CUHK_SOLES}[machine])


def _estimate(leg, rng):  # noqa: ANN001, ANN202
    """A short and noisy identification, so that the covariance matters."""
    t = np.arange(0.0, 8.0, 0.005)
    turns = np.outer(t, 2.0 * np.pi * np.array([0.3, 0.7, 1.3]))
    waves = [0.2 * np.sin(turns + rng.uniform(0.0, 6.0, 3)).sum(axis=1) for _ in leg.joint_names]
    lower, upper, *_ = leg.limits
    q = 0.5 * (np.clip(lower, -1, 1) + np.clip(upper, -1, 1)) + 0.5 * np.column_stack(waves)
    curve = scipy.interpolate.CubicSpline(t, q)
    v, a = curve(t, 1), curve(t, 2)
    tau = leg.inverse_dynamics(q, v, a) + 1.0 * np.tanh(v / 0.02) + 0.2 * v + 0.1 * a
    tau = tau + 0.8 * rng.standard_normal(tau.shape)
    noisy = q + 1e-4 * rng.standard_normal(q.shape)
    terms = (Coulomb(smoothing=0.02, reversal_speed=0.0), Viscous(), Armature())
    return identify(leg, Recording(time=t, q=noisy, tau=tau, joint_names=leg.joint_names), terms, check=False)


def _swings(estimate, time, q, height, rng, count):  # noqa: ANN001, ANN202
    """Least clearance of true legs that are drawn from the estimate, at once: q, v are (B, n)."""
    model, dt, n = estimate.model, 5e-4, q.shape[1]
    beta = rng.multivariate_normal(estimate.values, estimate.covariance, count)
    fine = np.arange(time[0], time[-1] + 0.5 * dt, dt)
    curve = scipy.interpolate.CubicSpline(time, q)
    qd, vd, ad = curve(fine), curve(fine, 1), curve(fine, 2)
    x = qd[0] - START * rng.standard_normal((count, n))
    v = np.tile(vd[0], (count, 1))
    raised, every, states = HIP * rng.standard_normal(count), round(float(time[1] - time[0]) / dt), []
    for k in range(len(fine)):
        if k % every == 0:
            states.append(x.copy())
        wanted = ad[k] + KD * (vd[k] - v) + KP * (qd[k] - x)
        tau = model.regressor(x, v, wanted) @ estimate.values
        drift = np.einsum("bnp,bp->bn", model.regressor(x, v, np.zeros_like(v)), beta)
        units = [model.regressor(x, v, np.tile(e, (count, 1))) for e in np.eye(n)]
        M = np.stack([np.einsum("bnp,bp->bn", unit, beta) - drift for unit in units], axis=2)
        v = v + dt * np.linalg.solve(M, (tau - drift)[..., None])[..., 0]
        x = x + dt * v
    paths = np.array(states)[: len(time)].transpose(1, 0, 2)  # (B, N, n)
    return np.array([height(path).min() for path in paths]) + raised


def main() -> None:
    """Read the options and print the tables."""
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", default="bleex,cuhk")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=60.0, help="of each day")
    parser.add_argument("--events", type=int, default=100, help="planted faults of each day")
    parser.add_argument("--swings", type=int, default=400)
    parser.add_argument("--frozen", action="store_true", help="frozen encoders alone, of the true model")
    parser.add_argument("--toe", action="store_true", help="toe clearance alone")
    options = parser.parse_args()
    for machine in options.machines.split(","):
        for seed in range(options.first, options.first + options.seeds):
            if options.frozen:
                print(machine, seed, ", ".join(f"{name} {n}" for name, n in frozen(machine, seed).items()), flush=True)
                continue
            if not options.toe:
                found = coordinate(machine, seconds=options.seconds, events=options.events, seed=seed)
                print(coordination_report(found), flush=True)
            found = toe(machine, seed, options.swings)
            print(machine, seed, ", ".join(f"{name} {value:.3g}" for name, value in found.items()), flush=True)


if __name__ == "__main__":
    main()
