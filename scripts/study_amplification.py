"""Does the predicted largest amplification agree with the boundary of simulated worn legs?

For each leg, true legs are drawn from N(β̂, Σ) around a model whose parameters have a relative standard deviation
(--std). The controller uses β̂. A wearer holds the leg at the worst pose, from a start that is no rest. For each draw,
worn legs run side by side on the virtual rig at amplifications around the prediction. From the growth of their motion
in the second half of the run follows the amplification at which motion neither grows nor decays.

* Without Coulomb friction, as in the prediction: ratio of simulated and predicted boundary.
* With Coulomb friction of leg and controller, released 5° off: how many legs move faster in the end, 10 % inside and
  10 % outside the boundary, and at 1.5 times the predicted amplification.

    OMP_NUM_THREADS=1 python scripts/study_amplification.py
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import fsolve

import exoid
from exoid import published
from exoid._typing import FloatArray
from exoid.control import ControlModel, sensitivity_amplification, simulate_many
from exoid.control.tracking import Tracking
from exoid.experiments import Hold
from exoid.lab.stability import largest_amplification
from exoid.lab.stability.draws import draw_truths
from exoid.rig import Sensors, Wearer
from exoid.torques import Coulomb, TorqueModel, Viscous

FACTORS = (0.9, 0.95, 1.0, 1.05, 1.1)
"""Amplifications of the runs over the predicted one."""
TERMS = {
    "bleex": {"c0_hip": 0.5, "c0_knee": 0.53, "c0_ankle": 0.26, "d_hip": 0.3, "d_knee": 0.2, "d_ankle": 0.1},
    "cuhk": published.cuhk_resistances(),
}
"""Friction beside the inertias of the URDF."""


RUBBING = (0.9, 1.1, 1.5)
"""The same with Coulomb friction."""
DRAWS = 8
"""Draws for each that must have a boundary."""
SMALL, LARGE = np.deg2rad([0.05, 5.0])
"""Distance of the start from rest, without and with Coulomb friction [rad]."""
GROWN = 1.0
"""RMS speed at the end from which motion has grown, as the release makes less [rad/s]."""


class Boundary(NamedTuple):
    """Predicted boundary of one true leg, and what the simulated legs do at each factor, (F,).

    Attributes:
        predicted: Predicted largest amplification.
        growth: Growth of the speed in the second half [1/s].
        speed: Largest RMS speed of a joint in the last quarter [rad/s].
    """

    predicted: float
    growth: FloatArray
    speed: FloatArray


def model_of(name: str) -> tuple[TorqueModel, FloatArray]:
    """Make the leg with friction, and its parameters."""
    model = TorqueModel(exoid.load_leg(name), (Coulomb(smoothing=0.02, reversal_speed=0.0), Viscous()))
    values = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True)) | TERMS[name]
    return model, np.array([values[each] for each in model.names])


def without_coulomb(model: ControlModel) -> ControlModel:
    """Take Coulomb friction out of a model."""
    return replace(model, coulomb=np.zeros(model.n))


def intention(truth: ControlModel, used: ControlModel, wearer: Wearer, pose: FloatArray) -> FloatArray:
    """Find the intended pose with which leg and limb rest at a pose, (n,), although the model is wrong."""
    k, muscles = (np.broadcast_to(np.ravel(x), pose.shape) for x in (wearer.cuff_stiffness, wearer.muscle_stiffness))
    carried = truth.statics(pose) - used.statics(pose)
    limb, at = ControlModel.of(wearer.limb), pose + carried / k

    def imbalance(intended: FloatArray) -> FloatArray:
        return limb.statics(at) + carried - limb.statics(intended) - muscles * (intended - at)

    return np.asarray(fsolve(imbalance, at))


def boundaries(name: str, std: float, count: int, delay: int, seconds: float, coulomb: bool) -> list[Boundary]:
    """Predict and simulate the boundaries of draws that have one.

    Args:
        name: Leg.
        std: Relative standard deviation of the parameters.
        count: Number of draws with a boundary.
        delay: Delay of the readings in sampling periods.
        seconds: Duration of each run.
        coulomb: Whether leg and controller have Coulomb friction.

    Returns:
        One boundary for each draw.
    """
    model, means = model_of(name)
    used = ControlModel.of_parameters(model, means)
    start = Hold(np.zeros((used.n, 1)))
    wearer = Wearer.build(model.leg, intention=start)
    draws, _ = draw_truths(model, means, np.diag((std * means) ** 2), DRAWS * count, seed=1)
    found: list[Boundary] = []
    truths = [ControlModel.of_parameters(model, draw) for draw in draws]
    values = largest_amplification(used, truth=truths, wearer=wearer, delay=delay).values
    for truth in [each for each, value in zip(truths, values, strict=True) if 1.1 < value < 50.0]:
        predicted = largest_amplification(used, truth=truth, wearer=wearer, delay=delay)
        pair = (truth, used) if coulomb else (without_coulomb(truth), without_coulomb(used))
        tried = predicted.largest * np.array(RUBBING if coulomb else FACTORS)
        groups = np.split(tried, len(tried)) if coulomb else [tried]  # one by one, as some may diverge
        grown = [
            run(*pair, wearer, predicted.pose, group, delay, seconds, LARGE if coulomb else SMALL) for group in groups
        ]
        found.append(Boundary(predicted.largest, *np.concatenate(grown, axis=1)))
        if len(found) == count:
            break
    return found


def run(
    truth: ControlModel,
    used: ControlModel,
    wearer: Wearer,
    pose: FloatArray,
    amplifications: Sequence[float] | FloatArray,
    delay: int,
    seconds: float,
    away: float,
) -> FloatArray:
    """Simulate worn legs that are released near a pose; growth and last speed for each amplification, (2, F)."""
    laws = tuple(sensitivity_amplification(used, float(each)) for each in amplifications)
    aim = intention(truth, used, wearer, pose)
    plant = truth.plant(end_stops=False).repeat(len(laws))
    try:
        runs = simulate_many(
            plant,
            laws,
            Hold(pose[:, None]),
            seconds,
            sensors=Sensors(encoder_counts=np.inf, delay=delay),
            start=np.tile(pose[:, None] + away, (1, len(laws))),
            wearer=replace(wearer, intention=Hold(aim[:, None])),
        )
    except exoid.ExoidError as error:
        if not any(text in str(error) for text in ("diverged", "looks like degrees")):
            raise
        return np.full((2, len(laws)), np.inf)
    return np.transpose([_growth(each) for each in runs])


def _growth(run: Tracking) -> tuple[float, float]:
    """Growth rate of the RMS speed from the third to the last quarter [1/s], and the last speed [rad/s]."""
    quarters = np.array_split(run.v, 4)
    sizes = [max(float(np.sqrt((quarter**2).mean(axis=0)).max()), 1e-300) for quarter in quarters]
    return float(np.log(sizes[3] / sizes[2]) / (0.25 * run.time[-1])), sizes[3]


def report(name: str, given: argparse.Namespace) -> None:
    """Print ratios and growth of one leg."""
    for delay in given.delays:
        part = partial(boundaries, name, given.std, given.draws, delay, given.seconds)
        found = part(False)
        ratios = np.array([np.interp(0.0, each.growth, FACTORS, left=np.nan, right=np.nan) for each in found])
        inside, outside = ([each.growth[k] for each in found] for k in (0, -1))
        alphas = ", ".join(f"{each.predicted:.2f}" for each in found)
        print(f"{name}, delay {delay}: {len(found)} draws, predicted largest amplification {alphas}")
        print(f"  simulated over predicted {ratios.min():.4f} to {ratios.max():.4f}")
        print(f"  growth [1/s] at × 0.9: {min(inside):.2g} to {max(inside):.2g}", end="; ")
        print(f"at × 1.1: {min(outside):.2g} to {max(outside):.2g}", flush=True)
        if given.coulomb:
            speeds = np.array([each.speed for each in part(True)])
            lasting = ", ".join(
                f"{count} at × {factor:g}" for count, factor in zip((speeds > GROWN).sum(axis=0), RUBBING, strict=True)
            )
            diverged = int(np.isinf(speeds[:, -1]).sum())
            print(
                f"  with Coulomb friction, legs whose motion has grown: {lasting}; {diverged} diverged at the last",
                flush=True,
            )


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--legs", default="bleex,cuhk")
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--std", type=float, default=0.15, help="relative standard deviation of all parameters")
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--delays", type=lambda text: [int(each) for each in text.split(",")], default=[0, 2])
    parser.add_argument("--coulomb", action="store_true", help="simulate with Coulomb friction too")
    given = parser.parse_args()
    for name in given.legs.split(","):
        report(name, given)


if __name__ == "__main__":
    main()
