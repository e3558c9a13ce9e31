"""Replay of document 1: experiments on a virtual BLEEX, the document's identification, and a joint estimate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments import bleex
from exoid.identification import identify
from exoid.leg.catalog import load_leg
from exoid.leg.leg import Leg
from exoid.leg.published import bleex_parameters
from exoid.signals import Poses, Recording, Smoothed
from exoid.tools.json_values import named
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .bleex_measurements import Extent, Measurements, measure_bleex, truth_values
from .sequential import bleex as steps
from .sequential.estimate import SequentialEstimate
from .torque_error import torque_nrmse

SIDES = ("left", "right")

JOINT_TERMS = (Stiffness(), Coulomb(smoothing=0.0, dead_band=0.15))
"""Terms of the joint estimate; samples near a velocity reversal are left out, never filtered across it."""

JOINT_PREPARATION = Smoothed(cutoff=8.0)
"""Preparation of the joint estimate."""


@dataclass(frozen=True, eq=False, repr=False)
class SideReplay:
    """One leg, identified by several methods."""

    leg: Leg  # leg with CAD inertias
    truth: Mapping[str, float]  # true parameters of the rig by name
    data: Measurements  # measurements
    sequential: SequentialEstimate  # estimate by the document's procedure
    one_sided: SequentialEstimate  # estimate by the same procedure from A⁺ alone, without averaging
    coarse: SequentialEstimate  # estimate by the same procedure with an encoder of 2^12 counts
    joint: Estimate  # estimate from all rows at once, torso tilts included
    upright_condition: float  # condition number of the joint estimate without the tilts
    cad: Mapping[str, float]  # parameters of Table V, without friction and stiffness
    # torque error of "sequential", "joint", "cad" and "truth" on the validation motion, (3,) each
    nrmse: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class BleexReplay:
    """Replay of document 1 for both legs."""

    left: SideReplay  # left leg
    right: SideReplay  # right leg
    seed: int  # seed of poses and noise


def reproduce_bleex(
    seed: int = 0,
    replicates: int = 1,
    progress: Callable[[float], None] | None = None,
    extent: Extent | None = None,
) -> list[BleexReplay]:
    """Run all experiments of document 1 on virtual rigs and identify both legs.

    Args:
        seed: Seed of random poses and sensor noise.
        replicates: Number of replicates with independent noise.
        progress: Function that receives the completed share, 0 to 1.
        extent: Duration of the motions and number of poses; None for those of the document.

    Returns:
        One replay for each replicate.

    Raises:
        ExoidError: The number of replicates is below one, or the measurements are too few.
    """
    if replicates < 1:
        raise BadArgumentError(f"{replicates} replicates", remedy="request at least one")
    report, extent = progress or (lambda _: None), extent or Extent()
    rng = np.random.default_rng(seed)
    measured = {}
    for side, done in zip(SIDES, (0.0, 0.48), strict=True):

        def report_side(share: float, done: float = done) -> None:
            """Each leg is about half of the work."""
            report(done + 0.48 * share)

        measured[side] = measure_bleex(side, rng, replicates, extent, report_side)
    replays = []
    for k in range(replicates):
        left, right = (_identify_side(side, measured[side][k]) for side in SIDES)
        replays.append(BleexReplay(left, right, seed))
    report(1.0)
    return replays


def identify_bleex(seed: int = 0, progress: Callable[[float], None] | None = None) -> Estimate:
    """Identify the left leg from all its rows at once, without the other methods and the other leg."""
    report, rng = progress or (lambda _: None), np.random.default_rng(seed)
    data = measure_bleex("left", rng, 1, Extent(), report)[0]
    return _joint_estimate(load_leg("bleex", side="left"), data)


def _joint_estimate(leg: Leg, data: Measurements) -> Estimate:
    """Identify from all rows at once, torso tilts included."""
    recordings = [recording for swings in data.swings for recording in swings]
    rows: list[Recording | Poses] = [data.upright.averaged, *data.tilted, *recordings]
    return identify(leg, rows, JOINT_TERMS, preparation=JOINT_PREPARATION)


def _identify_side(side: str, data: Measurements) -> SideReplay:
    """Identify one leg by all methods."""
    leg = load_leg("bleex", side=side)
    model = steps.document_model(leg)
    recordings = [recording for swings in data.swings for recording in swings]
    upright = data.upright.averaged
    joint = _joint_estimate(leg, data)
    no_tilt = identify(leg, [upright, *recordings], JOINT_TERMS, preparation=JOINT_PREPARATION, check=False)
    sequential = sequential_bleex(model, data.sets, upright, data.swings)
    truth, cad = truth_values(side), bleex_parameters("cad")
    models = {"sequential": sequential.as_dict(), "joint": named(joint.names, joint.values), "cad": cad, "truth": truth}
    return SideReplay(
        leg=leg,
        truth=truth,
        data=data,
        sequential=sequential,
        one_sided=sequential_bleex(model, data.sets, data.upright.below, data.swings),
        coarse=sequential_bleex(model, data.sets, upright, data.coarse),
        joint=joint,
        upright_condition=no_tilt.condition_number,
        cad=cad,
        nrmse={name: torque_nrmse(model, values, data.validation) for name, values in models.items()},
    )


def sequential_bleex(
    model: TorqueModel, sets: bleex.StaticSets, poses: Poses, swings: tuple[tuple[Recording, ...], ...]
) -> SequentialEstimate:
    """Identify by all steps of document 1: statics of ankle, knee and hip, then inertias, then kinetic friction."""
    ankle, knee, pairs, random = sets.split(poses)
    known = steps.stiffness_coefficients(model, SequentialEstimate(), ankle, sets.ankle_set, steps.ANKLE)
    known = steps.ankle_offset(model, known, pairs)
    known = steps.mass_moments(model, known, random, steps.ANKLE)
    known = steps.stiffness_coefficients(model, known, knee, sets.knee_set, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.HIP)
    known = steps.inertia(model, known, swings[steps.KNEE], 3)
    known = steps.inertia(model, known, swings[steps.HIP], 2)
    known = steps.inertia(model, known, swings[steps.HIP], 1)
    known = steps.kinetic_friction(model, known, swings[steps.ANKLE], steps.ANKLE)
    return steps.kinetic_friction(model, known, swings[steps.KNEE], steps.KNEE)
