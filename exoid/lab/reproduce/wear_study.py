"""What a wearer feels: a leg that is off, or amplified by CAD, by an identified model, or by the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from exoid._typing import FloatArray
from exoid.control import ControlModel, Tracking, pd, sensitivity_amplification, simulate_many
from exoid.control.law import AnyLaw
from exoid.control.model import ModelSource
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.lab.stability import Amplification, largest_amplification
from exoid.lab.stability.amplification import AmplifiedLaw
from exoid.lab.stability.worn_loop import poses_of
from exoid.rig import Plant, Reference, Sensors, Wearer

from .wear_models import WornModels, worn_models

MODELS = ("off", "cad", "identified", "truth")
"""What the controller knows; "off" is no torque at all."""

BANDWIDTH, RATE = 50.0, 1000.0
"""Bandwidth of the motion filter, and rate of the controller [Hz]."""

MARGIN = 0.9
"""Share of the largest stable amplification that is used."""

SENSORS = Sensors(velocity_noise=0.002, delay=1)
"""Readings of the controller: 16-bit encoders, 2 mrad/s of noise, one period late."""

PERIOD, SCALE = 4.0, 0.8
"""Default period of the stride [s], and factor of its amplitude: within the limits of both legs."""


@dataclass(frozen=True, eq=False, repr=False)
class Felt:
    """What the wearer feels with one controller."""

    model: str  # one of `MODELS`
    amplification: float | None  # amplification α; None where the leg is off
    run: Tracking  # the run, whose first stride is not evaluated

    @property
    def rms(self) -> FloatArray:
        """RMS torque of the wearer at each joint [N·m], (n,)."""
        assert self.run.rms_interaction is not None
        return self.run.rms_interaction

    @property
    def rms_of_all(self) -> float:
        """Root of the mean square over all joints [N·m]."""
        return float(np.sqrt(np.mean(self.rms**2)))


@dataclass(frozen=True, eq=False, repr=False)
class WearStudy:
    """What a wearer feels in one leg."""

    name: str  # name of the leg
    joint_names: tuple[str, ...]  # names of the joints, (n,)
    felt: Mapping[str, Felt]  # what is felt with each of `MODELS`
    largest: Mapping[str, Amplification]  # largest stable amplification with "cad", "identified" and "truth"
    # RMS of 1/α of the true leg's inertia and friction over the intended stride, with the α of "truth" [N·m],
    # (n,): what is felt with an exact model, without lag and noise
    floor: FloatArray
    period: float  # period of the stride [s]
    seed: int  # seed of noise and draws

    @property
    def floor_of_all(self) -> float:
        """Root of the mean square of :attr:`floor` over all joints [N·m]."""
        return float(np.sqrt(np.mean(self.floor**2)))


def wear(
    source: str | Estimate | WornModels,
    *,
    period: float = PERIOD,
    bandwidth: float = BANDWIDTH,
    rate: float = RATE,
    most: float = 10.0,
    height: float = 1.75,
    mass: float = 70.0,
    roles: Mapping[str, str] | None = None,
    largest: Mapping[str, Amplification] | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> WearStudy:
    """Let a wearer walk in a leg on the virtual rig, and compare what is felt.

    The wearer's limb (by anthropometry) hangs in cuffs, and its muscles intend a stride. The controller is sensitivity
    amplification. Its model is the CAD, the identified one, or the truth, each with the largest stable amplification,
    less a margin of 10 %, and at most ``most``. The same wearer also walks with the leg off.

    See :func:`.wear_models.worn_models` for the models.

    Args:
        source: "bleex", "cuhk", an estimate, or models of one leg.
        period: Period of the stride [s].
        bandwidth: Bandwidth of the controller's motion filter [Hz].
        rate: Rate of the controller [Hz].
        most: Largest amplification.
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].
        roles: "hip", "knee" or "ankle" for each joint that has another name.
        largest: Largest stable amplifications of the same models, controller and wearer, as of another stride, on which
            they do not depend; None to find them.
        seed: Seed of noise and draws.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        What is felt, and the largest amplifications.

    Raises:
        ExoidError: There is no such leg, a setting is invalid, the stride leaves the limits of the leg, or the leg has
            no gait, or a model is so wrong that the worn leg is unstable even without amplification.

    Example:
        >>> study = wear("cuhk")  # doctest: +SKIP
        >>> study.felt["identified"].rms_of_all < 0.2 * study.felt["cad"].rms_of_all  # doctest: +SKIP
        True
    """
    if not (0.0 < period < np.inf and 1.0 < most < np.inf):
        raise BadArgumentError(
            f"a stride of {period:g} s and amplifications up to {most:g}",
            remedy="give a positive period in s, and a largest amplification above 1",
        )
    report = progress or (lambda _: None)
    cad, identified, truth = worn_models(source, seed, lambda share: report(0.5 * share))
    intention = gait_for_leg(truth.leg, healthy_gait(SCALE, period), roles)
    refuse_motion_beyond_limits(truth.leg, intention, period)
    wearer = Wearer.build(truth.leg, height, mass, roles=roles, intention=intention)
    law = partial(sensitivity_amplification, bandwidth=bandwidth, rate=rate)
    drawing, exact = (replace(ControlModel.of(one), passive=identified.passive) for one in (cad, truth))
    sources: dict[str, ModelSource] = {"cad": drawing, "identified": identified, "truth": exact}
    if largest is None:
        # Largest amplification that is tried, over the largest that is used.
        largest = _largest(sources, truth, wearer, law, 2.0 * most, seed, poses_of(truth.leg, None, roles))
    for name, each in largest.items():
        if each.largest < 1.0:  # not stable even where the controller only carries the weight
            what = f"with the {name} model the worn leg is unstable even without amplification"
            remedy = "raise the rate or the bandwidth of the controller, or check the model's masses"
            raise BadArgumentError(what, remedy=remedy)
    report(0.8)
    amplifications = {name: float(np.clip(MARGIN * each.largest, 1.0, most)) for name, each in largest.items()}
    laws: list[AnyLaw] = [pd(0.0, 0.0, rate=rate), *(law(sources[name], each) for name, each in amplifications.items())]
    runs = simulate_many(
        truth.repeat(len(laws)),
        laws,
        intention,
        2 * period,  # strides of a run; the first is not evaluated
        sensors=SENSORS,
        settle=period,
        wearer=wearer,
        seed=seed,
        names=("off", *amplifications),
        progress=lambda share: report(0.8 + 0.2 * share),
    )
    felt = {run.law: Felt(run.law, amplifications.get(run.law), run) for run in runs}
    report(1.0)
    leg, floor = truth.leg, _inertia_and_friction(truth, intention, period) / amplifications["truth"]
    return WearStudy(leg.description.name, leg.joint_names, felt, largest, floor, period, seed)


def _largest(
    sources: Mapping[str, ModelSource],
    truth: Plant,
    wearer: Wearer,
    law: AmplifiedLaw,
    most: float,
    seed: int,
    poses: FloatArray,
) -> dict[str, Amplification]:
    """Find the largest stable amplification of each model: the identified one over its distribution, others exactly."""
    found = {}
    for name, model in sources.items():
        given = None if name == "identified" else truth
        found[name] = largest_amplification(
            model, wearer=wearer, truth=given, law=law, delay=SENSORS.delay, most=most, seed=seed, poses=poses
        )
    return found


def _inertia_and_friction(truth: Plant, intention: Reference, period: float) -> FloatArray:
    """RMS of M q̈ + C q̇ + F over a stride [N·m], (n,)."""
    model = ControlModel.of(truth)
    targets = [intention.at(time) for time in np.linspace(0.0, period, 400, endpoint=False)]
    q, v, a = (np.column_stack([getattr(target, name)[:, 0] for target in targets]) for name in ("q", "v", "a"))
    torque = model.inverse_dynamics(q, v, a) - model.statics(q) + model.friction(q, v, 0.0)
    return np.asarray(np.sqrt((torque**2).mean(axis=1)))
