"""Friction selected joint by joint, on simulated robots whose friction is known and on a real machine.

    python scripts/study_selection.py [dfki] [cuhk] [bleex] [panda] [ur5] [kinova] [panda+] ... [random] [sticking]

Prints for each robot what is true and what is selected at each joint, NRMSE on a motion that was not fitted, over that
of the model with the true friction terms, processor time, and the least friction power over speeds and loads. All
joints of a robot with a "+" have presliding and load friction; else some have. For the real machine it prints the test
error, and the error on the fast part of the log after a fit of the slow part. "sticking" takes a log and another motion
of `study_sharp_friction.py`, whose joints stick at reversals.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import exoid
from exoid import Armature, Leg, Recording
from exoid._typing import FloatArray
from exoid.identification.selection import Selection, select_terms
from exoid.identification.selection.held_out import fast_blocks
from exoid.identification.selection.patterns import Column, JointFriction, Pattern, terms_of
from exoid.signals import ZeroPhase
from exoid.torques import TorqueModel

ROBOTS = {
    "panda": tuple(f"panda_joint{k}" for k in range(1, 8)),
    "ur5": None,
    "kinova": tuple(f"j2s6s200_joint_{k}" for k in range(1, 7)),
}
RATE, SECONDS = 1000.0, 20.0
NOISE = 0.01
"""Noise of the torques, as a part of their standard deviation."""


@dataclass(frozen=True)
class Simulation:
    """A robot with friction of a different kind and size at each joint.

    Attributes:
        leg: The robot.
        columns: Friction columns of each joint.
        coefficients: Their values.
    """

    leg: Leg
    columns: tuple[tuple[Column, ...], ...]
    coefficients: tuple[tuple[float, ...], ...]

    @property
    def model(self) -> TorqueModel:
        """Torque model with the true terms and rigid bodies."""
        pairs = zip(self.columns, self.leg.joint_names, strict=True)
        terms = tuple(term for columns, joint in pairs for term in terms_of(columns, joint))
        return TorqueModel(self.leg, (*terms, Armature()), self.leg.parameters)

    @property
    def zero(self) -> dict[str, float]:
        """Coefficients that the true terms do not use."""
        zero = dict[str, float]()
        for columns, label in zip(self.columns, self.leg.joint_labels, strict=True):
            used, every = {c.symbol for c in columns}, (symbol for c in columns for symbol in c.term.symbols)
            zero |= {f"{symbol}_{label}": 0.0 for symbol in every if symbol not in used}
        return zero

    def record(self, seed: int) -> Recording:
        """Move all joints, and compute torques."""
        q, v, a = motion(self.leg, seed)
        model = self.model
        values = dict.fromkeys(model.names, 0.0)
        values |= dict(zip(self.leg.parameter_names, self.leg.parameters.tolist(), strict=True))
        for columns, numbers, label in zip(self.columns, self.coefficients, self.leg.joint_labels, strict=True):
            values |= {f"{c.symbol}_{label}": x for c, x in zip(columns, numbers, strict=True)}
        tau = model.regressor(q, v, a) @ np.array(list(values.values()))
        noise = NOISE * tau.std(axis=0) * np.random.default_rng(seed).standard_normal(tau.shape) * np.sqrt(RATE / 100.0)
        time_ = np.arange(len(q)) / RATE
        return Recording(time=time_, q=q, tau=tau + noise, joint_names=self.leg.joint_names)


def motion(leg: Leg, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Six harmonics of 0.1 Hz within limits of angle and speed, with a slow half and a fast half."""
    rng = np.random.default_rng(seed)
    n = len(leg.joint_names)
    t = np.arange(round(RATE * SECONDS)) / RATE
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 7)
    amplitude = rng.uniform(0.3, 1.0, (n, 6)) / np.arange(1, 7) ** 0.7
    angle = np.multiply.outer(t, omega)[:, None, :] + rng.uniform(0.0, 2.0 * np.pi, (n, 6))
    q = (amplitude * np.sin(angle)).sum(-1)
    v = (amplitude * omega * np.cos(angle)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(angle)).sum(-1)
    lower, upper = np.maximum(leg.limits.lower, -np.pi), np.minimum(leg.limits.upper, np.pi)
    room = np.where(upper > lower, upper - lower, np.pi)
    middle = np.where(upper > lower, 0.5 * (upper + lower), 0.0)
    speed = np.where(np.isfinite(leg.limits.velocity) & (leg.limits.velocity > 0.0), leg.limits.velocity, 2.0)
    scale = np.minimum(0.45 * room / np.abs(q).max(axis=0), 0.8 * np.minimum(speed, 2.0) / np.abs(v).max(axis=0))
    return middle + scale * q, scale * v, scale * a


def simulate(name: str, *, every: bool = False) -> Simulation:
    """Friction with presliding and load of different size at each joint, in parts of the joint's torque.

    Load acts at every second joint, and two thirds have presliding; or every joint has both.
    """
    if name in ROBOTS:
        from example_robot_data.robots_loader import ROBOTS as KNOWN  # noqa: PLC0415 - only for these robots
        from example_robot_data.robots_loader import getModelPath  # noqa: PLC0415

        entry = KNOWN[name]
        inside = Path(entry.path) / entry.urdf_subpath / entry.urdf_filename
        leg = Leg.from_urdf(Path(getModelPath(str(inside))) / inside, ROBOTS[name])
    else:
        leg = exoid.load_leg(name)
    size = leg.inverse_dynamics(*motion(leg, 0)).std(axis=0)
    rng = np.random.default_rng(5)
    columns, coefficients = [], []
    for joint in range(len(leg.joint_names)):
        length = float(np.exp(rng.uniform(np.log(8e-4), np.log(8e-3))))
        level = max(size[joint], 0.05 * float(size.max()))
        kinds = [("c0", rng.uniform(0.1, 0.3) * level), ("d", rng.uniform(0.05, 0.15) * level)]
        if every or joint % 2 == 0:
            kinds.append(("mu", rng.uniform(0.1, 0.25)))
        bent = every or joint % 3 != 1
        columns.append(tuple(Column(s, length if bent and s != "d" else 0.0) for s, _ in kinds))
        coefficients.append(tuple(float(x) for _, x in kinds))
    return Simulation(leg, tuple(columns), tuple(coefficients))


def simulate_random(seed: int) -> Simulation:
    """CUHK-EXO with random terms and sizes at each joint."""
    rng, leg = np.random.default_rng(seed), exoid.load_leg("cuhk")
    columns, coefficients = [], []
    for size in leg.inverse_dynamics(*motion(leg, 0)).std(axis=0):
        length = float(np.exp(rng.uniform(np.log(6e-4), np.log(8e-3)))) if rng.random() < 0.6 else 0.0
        velocity = float(np.exp(rng.uniform(np.log(0.06), np.log(0.4))))
        kinds = {"c0": rng.uniform(0.05, 0.25) * size}
        kinds |= {"d": rng.uniform(0.05, 0.2) * size} if rng.random() < 0.7 else {}
        load = rng.random()
        kinds |= {"mu" if load < 0.35 else "mu_back": rng.uniform(0.08, 0.25)} if load < 0.5 else {}
        kinds |= {"cs": rng.uniform(0.05, 0.15) * size} if rng.random() < 0.35 else {}
        pattern = Pattern(tuple(kinds), presliding=length > 0.0)
        columns.append(pattern.columns(length, velocity))
        coefficients.append(tuple(float(value) for value in kinds.values()))
    return Simulation(leg, tuple(columns), tuple(coefficients))


def missing(joint: JointFriction, true: tuple[Column, ...]) -> list[str]:
    """Terms of the truth that a choice lacks; mu_drive and mu_back together have mu."""
    both = {"mu"} if {"mu_drive", "mu_back"} <= {*joint.coefficients} else set()
    lacking = sorted({column.symbol for column in true} - {*joint.coefficients} - both)
    return lacking + ["presliding"] * (any(column.length for column in true) and not joint.presliding)


def least_power(selection: Selection, speed: FloatArray, load: FloatArray) -> float:
    """Least sliding friction over |v| up to ten times the speed seen, and 1.5 times the load; negative if it drives."""
    estimate = selection.estimate
    assert estimate is not None
    least = np.inf
    for index, label in enumerate(selection.leg.joint_labels):
        values = {
            n.split("_" + label)[0]: x
            for n, x in zip(estimate.names, estimate.values, strict=True)
            if n.endswith(label)
        }
        v = np.concatenate([np.geomspace(1e-4, 10.0 * speed[index], 200)])
        vs = selection.joints[index].stribeck_velocity or 1.0
        for size in np.linspace(0.0, 1.5 * load[index], 10):
            for side in ("mu_drive", "mu_back"):
                mu = values.get("mu", 0.0) + values.get(side, 0.0)
                dry = values.get("c0", 0.0) + mu * size + values.get("cs", 0.0) * np.exp(-((v / vs) ** 2))
                least = min(least, float((dry + values.get("d", 0.0) * v).min()))
    return least


def study_simulation(name: str, sim: Simulation) -> None:
    """Select on one motion, predict another."""
    train, test = sim.record(1), sim.record(2)
    begin = time.process_time()
    selection = select_terms(sim.leg, train)
    spent = time.process_time() - begin
    estimate = selection.estimate
    found = exoid.validate(estimate, test).nrmse
    model = sim.model
    truth = exoid.identify(sim.leg, train, model.terms, preparation=ZeroPhase(8.0), known=sim.zero or None)
    best = exoid.validate(truth, test).nrmse
    print(f"\n{name}: {len(found)} joints, {spent:.1f} s of processor time, {selection.candidate.name}")
    ratio = found / best
    rows = zip(selection.joints, sim.columns, sim.coefficients, found, best, ratio, strict=True)
    for joint, true, numbers, mine, its, over in rows:
        sizes = ", ".join(f"{x:.2g}" for x in numbers)
        print(
            f"  {joint.joint:18s} true {JointFriction.of('', true).text:38s} [{sizes}]  selected {joint.text:42s}",
            end="",
        )
        print(f" NRMSE {mine:.4f} / {its:.4f} = {over:.2f}", *(f"missing {what}" for what in missing(joint, true)))
    load = np.abs(sim.leg.inverse_dynamics(*motion(sim.leg, 1))).max(axis=0)
    speed = np.abs(motion(sim.leg, 1)[1]).max(axis=0)
    print(f"  worst NRMSE over truth's {ratio.max():.3f}; mean {found.mean() / best.mean():.3f}", end="")
    print(f"; least sliding friction {least_power(selection, speed, load):.3g} N·m")


def study_dfki() -> None:
    """Test error, and extrapolation from the slow part of the training log."""
    data = exoid.datasets.dfki_double_pendulum()
    begin = time.process_time()
    selection = select_terms(data.leg, data.train)
    print(f"DFKI: {time.process_time() - begin:.1f} s of processor time, {selection.candidate.name}")
    print("  ", "; ".join(f"{joint.joint}: {joint.text}" for joint in selection.joints))
    found = exoid.validate(selection.estimate, data.test)
    inner = (found.time >= data.test.time[0] + 0.48) & (found.time <= data.test.time[-1] - 0.48)
    away = np.sqrt((found.residual[inner] ** 2).mean(axis=0)) / found.measured[inner].std(axis=0)
    print("   test NRMSE", found.nrmse.round(4), "and 0.48 s away from the ends", away.round(4))
    (blocks,) = fast_blocks([data.train])
    fast = ((data.train.time >= blocks[:, :1]) & (data.train.time < blocks[:, 1:])).any(axis=0)
    slow = select_terms(data.leg, replace(data.train, mask=~fast))
    print("   slower seconds:", "; ".join(f"{joint.joint}: {joint.text}" for joint in slow.joints))
    errors = [exoid.validate(each.estimate, replace(data.train, mask=fast)).nrmse for each in (slow, selection)]
    print("   fastest seconds, fitted to the slower / to all:", *(each.round(4) for each in errors))


def study_sticking() -> None:
    """Errors of parameters, and of another motion, by what is selected and by the default terms."""
    import study_sharp_friction as sharp  # noqa: PLC0415 - needs MuJoCo

    for name in sharp.COULOMB:
        case = sharp.Case(name, seconds=40.0)
        (leg, train), (_, test) = sharp.record(case, 3), sharp.record(case, 4)
        selection = select_terms(leg, train)
        print(f"\n{name}, joints that stick:", "; ".join(joint.text for joint in selection.joints))
        for kind, estimate in (("selected", selection.estimate), ("default", exoid.identify(leg, train, check=False))):
            true = sharp.truth(estimate, case)
            worst = 100.0 * np.abs((estimate.values - true) / sharp.scale((*estimate.names,), true)).max()
            print(
                f"  {kind}: largest error {worst:.2f} %, NRMSE",
                exoid.validate(estimate, test, cutoff=8.0).nrmse.round(4),
            )


def main(names: Sequence[str]) -> None:
    """Run the studies that are named."""
    for name in names or ("dfki", "cuhk", "bleex", *ROBOTS, *(f"{robot}+" for robot in ("cuhk", "bleex", *ROBOTS))):
        if name == "dfki":
            study_dfki()
        elif name == "sticking":
            study_sticking()
        elif name == "random":
            for seed in range(10):
                study_simulation(f"random {seed}", simulate_random(seed))
        else:
            study_simulation(name, simulate(name.rstrip("+"), every=name.endswith("+")))


if __name__ == "__main__":
    main(sys.argv[1:])
