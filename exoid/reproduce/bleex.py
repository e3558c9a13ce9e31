"""Document 1 replayed: experiments on a virtual BLEEX, the document's identification, and what beats it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.experiments import bleex
from exoid.identification import identify
from exoid.leg import Leg
from exoid.published import bleex_parameters
from exoid.signals import Poses, Recording, Smoothed
from exoid.torques import Coulomb, Stiffness, TorqueModel

from .bleex_measurements import Extent, Measurements, measure_bleex, truth_of
from .sequential import Known
from .sequential import bleex as steps
from .torque_error import by_name, torque_nrmse

SIDES = ("left", "right")

JOINT_TERMS = (Stiffness(), Coulomb(smoothing=0.0, dead_band=0.15))
"""Of the joint estimate; samples near a reversal are left out, never filtered across it."""

JOINT_PREPARATION = Smoothed(cutoff=8.0)


@dataclass(frozen=True, eq=False)
class SideReplay:
    """One leg, identified in several ways.

    Attributes:
        leg: With CAD inertias.
        truth: What the rig was made of.
        data: What was measured.
        sequential: By the document's procedure.
        one_sided: By the same from A⁺ alone, without averaging.
        coarse: By the same with an encoder of 2^12 counts.
        joint: All rows at once, torso tilts included.
        upright_condition: Condition number of the same without the tilts.
        cad: Table V, without friction and stiffness.
        nrmse: Torque error on the validation motion of each of "sequential", "joint", "cad" and "truth", (3,).
    """

    leg: Leg
    truth: Mapping[str, float]
    data: Measurements
    sequential: Known
    one_sided: Known
    coarse: Known
    joint: Estimate
    upright_condition: float
    cad: Mapping[str, float]
    nrmse: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class BleexReplay:
    """Both legs.

    Attributes:
        left: Left leg.
        right: Right leg.
        seed: Of poses and noise.
    """

    left: SideReplay
    right: SideReplay
    seed: int


def reproduce_bleex(
    seed: int = 0,
    replicates: int = 1,
    progress: Callable[[float], None] | None = None,
    extent: Extent | None = None,
) -> list[BleexReplay]:
    """Run all experiments of document 1 on virtual rigs and identify both legs.

    Args:
        seed: Of random poses and sensor noise.
        replicates: How often everything is repeated with other noise, all at once.
        progress: Told the share that is done.
        extent: How much is measured; None for what the document measured.

    Returns:
        One replay for each replicate.

    Raises:
        ExoidError: There are no replicates, or too little is measured.
    """
    if replicates < 1:
        raise ExoidError(f"{replicates} replicates", remedy="ask for at least one")
    told, extent = progress or (lambda _: None), extent or Extent()
    rng = np.random.default_rng(seed)
    measured = {}
    for k, side in enumerate(SIDES):
        told_side = partial(_tell_part, told, 0.48 * k, 0.48)
        measured[side] = measure_bleex(side, rng, replicates, extent, told_side)
    replays = []
    for k in range(replicates):
        left, right = (_identify_side(side, measured[side][k]) for side in SIDES)
        replays.append(BleexReplay(left, right, seed))
    told(1.0)
    return replays


def _tell_part(told: Callable[[float], None], done: float, part: float, share: float) -> None:
    told(done + part * share)


def _identify_side(side: str, data: Measurements) -> SideReplay:
    """Identify one leg in all ways."""
    leg = load_leg("bleex", side=side)
    model = steps.document_model(leg)
    recordings = [recording for swings in data.swings for recording in swings]
    upright = data.upright.averaged
    joint = identify(leg, [upright, *data.tilted, *recordings], JOINT_TERMS, preparation=JOINT_PREPARATION)
    no_tilt = identify(leg, [upright, *recordings], JOINT_TERMS, preparation=JOINT_PREPARATION)
    sequential = sequential_bleex(model, data.sets, upright, data.swings)
    truth, cad = truth_of(side), bleex_parameters("cad")
    models = {"sequential": sequential.as_dict(), "joint": by_name(joint), "cad": cad, "truth": truth}
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
) -> Known:
    """All steps of document 1 in its order: ankle, knee and hip statics, then inertias, then kinetic friction.

    Args:
        model: Of :func:`exoid.reproduce.sequential.bleex.document_model`.
        sets: The poses asked for.
        poses: What was measured there, in the order of ``sets.all``.
        swings: Recordings of the swinging hip, knee and ankle.
    """
    ankle, knee, pairs, random = sets.split(poses)
    known = steps.stiffness_shape(model, Known(), ankle, sets.ankle_set, steps.ANKLE)
    known = steps.ankle_offset(model, known, pairs)
    known = steps.mass_moments(model, known, random, steps.ANKLE)
    known = steps.stiffness_shape(model, known, knee, sets.knee_set, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.HIP)
    known = steps.inertia(model, known, swings[steps.KNEE], 3)
    known = steps.inertia(model, known, swings[steps.HIP], 2)
    known = steps.inertia(model, known, swings[steps.HIP], 1)
    known = steps.kinetic_friction(model, known, swings[steps.ANKLE], steps.ANKLE)
    return steps.kinetic_friction(model, known, swings[steps.KNEE], steps.KNEE)
