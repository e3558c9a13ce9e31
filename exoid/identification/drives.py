"""Drives in an identification: torques of what they measure, terms and rotors of motors, and unknown constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.actuators import Actuators, Coupling, Drive, Motor
from exoid.actuators.constants import DriveConstant, unknown_constants
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording, Recordings
from exoid.torques import Armature, Motion, Term, TorqueModel

from .estimators import Estimator
from .estimators.by_name import name_of
from .group_rows import Data

Drives = Mapping[str, Drive | Coupling] | Actuators
"""Drive of each joint by its name, and couplings by any name; or actuators of the leg."""


def refuse_beside_unknown(
    mounted: Mapping[str, Actuators],
    estimator: Estimator,
    terms: Sequence[Term],
    delay: str | None,
    names: Sequence[str],
) -> None:
    """Refuse what cannot act beside unknown constants of drives."""
    constants = [each.name for actuators in mounted.values() for each in unknown_constants(actuators)]
    if not constants:
        return
    which = ", ".join(dict.fromkeys(constants))
    wrong = {
        "groups of recordings are fitted": [*mounted] != [""],
        f"{name_of(estimator)} fits the torque of every sample": getattr(estimator, "fits_samples", False),
        "terms depend on the load": any(term.loaded for term in terms),
        "delays are to be corrected": delay is not None,
    }
    remedy = "identify them first, by wls, without load friction and delays, from recordings of one leg"
    for what, is_so in wrong.items():
        if is_so:
            raise NotSupportedError(f"{which}: constants of drives are not found where {what}", remedy=remedy)
    told = [name for name in constants if name in names]
    if told:
        text = f"{', '.join(told)} is a constant of a drive, not a parameter of the leg"
        raise BadArgumentError(text, remedy="give the number to the drive: Motor(torque_constant=...)")


def computed_joints(leg: Leg, data: Data, actuators: Actuators) -> set[str]:
    """Joints whose torque was computed of their drives in some recording; of files, one is read."""
    every = {*actuators.drives, *(joint for each in actuators.couplings.values() for joint in each.joints)}
    some = [data[0]] if isinstance(data, Recordings) else data
    names = {name for one in some if isinstance(one, Recording) for name in one.computed}
    labels = zip(leg.joint_names, leg.joint_labels, strict=True)
    return {joint for joint, label in labels if joint in every and names & {joint, label}}


def known_rotors(
    leg: Leg, actuators: Actuators, computed: set[str], terms: Sequence[Term], knowledge: PriorKnowledge
) -> dict[str, float]:
    """Hold rotor inertias that motors state, unless the caller says otherwise."""
    # A torque sensor behind the gear does not see the rotor: only motors whose torque was computed have one.
    plain = {name.partition("[")[0] for name in knowledge.names}
    labels = dict(zip(leg.joint_names, leg.joint_labels, strict=True))
    armatures = (term.places(leg.joint_names, leg.joint_labels) for term in terms if type(term) is Armature)
    seen = computed & {leg.joint_names[joint] for places in armatures for (joint,) in places.values()}
    motors = {f"Ia_{labels[joint]}": one for joint, one in actuators.drives.items() if joint in seen}
    rotors = {name: one.armature for name, one in motors.items() if isinstance(one, Motor) and name not in plain}
    return {**{name: value for name, value in rotors.items() if value is not None}, **knowledge.known}


@dataclass(frozen=True, eq=False, repr=False)
class DriveModel(TorqueModel):
    """Both sides of τ(i, κ) = W β + τ_payload, linear in β and in changes δ of the constants κ of drives."""

    # τ(i, κ) is the torque that the drives make of their readings, such as ratio · k_t · i; τ_payload that of payloads
    # less Σ Jᵀw of measured wrenches w on the leg. About a point (β₀, κ₀):
    #
    #     τ(i, κ₀) − τ_payload = W β − s δ,    s = ∂τ/∂κ at the torque W β₀ + τ_payload of the model.
    #
    # The columns s are formed of the torque of the model, not of the measured currents. Noise of the currents therefore
    # stands on the left side only, and attenuates no constant. Where the solution is δ = 0, it solves
    # i = (W β + τ_payload) / (ratio · k_t), with the covariance of the Gauss-Newton method.

    point: FloatArray = field(kw_only=True)  # β₀, (P,)
    constants: tuple[DriveConstant, ...] = field(kw_only=True)  # the constants, K of them, whose changes are parameters
    actuators: Actuators = field(kw_only=True)  # drives with the constants κ₀

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, then of the constants, (P + K,)."""
        return (*super().names, *(each.name for each in self.constants))

    @cached_property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters and of the constants, (P + K,)."""
        return (*super().units, *(each.constant.unit for each in self.constants))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters and constants can act on which joint, (n, P + K)."""
        acting = super().acting
        for column, each in enumerate(self.constants, start=len(self.point)):
            acting[each.joint, column] = True
        return acting

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns W and −s for a motion, or for some rows of one."""
        out = super().columns(motion)
        torque = np.tensordot(self.point, out[: len(self.point)], axes=1)
        if motion.payload is not None:
            torque += motion.payload.T
        for column, each in enumerate(self.constants, start=len(self.point)):
            joint = each.joint
            if motion.computed is not None and motion.computed[joint]:
                drive = self.actuators.drives[self.leg.joint_names[joint]]
                slope = drive.sensitivity(each.constant.symbol, torque[joint], motion.v[:, joint])
                np.negative(slope, out=out[column, joint])
        return out
