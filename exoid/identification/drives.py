"""Drives in an identification: torques from what they measure, terms of their motors, and rotors that are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exoid.actuators import Actuators, Coupling, Drive, Motor, motor_terms
from exoid.actuators.constants import at_start, unknown_constants
from exoid.errors import BadArgumentError, NotSupportedError, within
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording, Recordings
from exoid.torques import DEFAULT_TERMS, Armature, Term

from .estimators import Estimator
from .estimators.by_name import name_of
from .group_rows import Data

Drives = Mapping[str, Drive | Coupling] | Actuators
"""Drive of each joint by its name, and couplings by any name; or actuators of the leg."""


def drive_groups(
    pairs: Mapping[str, tuple[Leg, Data]], drives: Drives
) -> tuple[dict[str, tuple[Leg, Data]], dict[str, Actuators]]:
    """Compute torques before anything else looks at the recordings; some constants of the actuators may be unknown."""
    driven, mounted = {}, {}
    for name, (leg, data) in pairs.items():
        with within(name):
            mounted[name] = Actuators.of(leg, drives)
            driven[name] = leg, at_start(mounted[name]).torques(data)
    return driven, mounted


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
        "terms are nonlinear or depend on the load": any(term.nonlinear or term.loaded for term in terms),
        "delays are to be corrected": delay is not None,
    }
    for what, is_so in wrong.items():
        if is_so:
            raise NotSupportedError(
                f"{which}: constants of drives are not found where {what}",
                remedy="identify them first, by wls and linear terms from recordings of one leg, and give the "
                "motors these numbers",
            )
    told = [name for name in constants if name in names]
    if told:
        raise BadArgumentError(
            f"{', '.join(told)} is a constant of a drive, not a parameter of the leg",
            remedy="give the number to the drive: Motor(torque_constant=...)",
        )


def computed_joints(leg: Leg, data: Data, actuators: Actuators) -> set[str]:
    """Joints whose torque was computed of their drives in some recording; of files, one is read."""
    every = {*actuators.drives, *(joint for each in actuators.couplings.values() for joint in each.joints)}
    some = [data[0]] if isinstance(data, Recordings) else data
    names = {name for one in some if isinstance(one, Recording) for name in one.computed}
    labels = zip(leg.joint_names, leg.joint_labels, strict=True)
    return {joint for joint, label in labels if joint in every and names & {joint, label}}


def default_terms(actuators: Actuators, computed: set[str]) -> tuple[Term, ...]:
    """Add friction and rotors of coupled motors to the default terms, where torque was computed of these motors."""
    used = [coupling for coupling in actuators.couplings.values() if computed & set(coupling.joints)]
    return (*DEFAULT_TERMS, *(term for coupling in used for term in motor_terms(coupling)))


def known_rotors(
    leg: Leg, actuators: Actuators, computed: set[str], terms: Sequence[Term], knowledge: PriorKnowledge
) -> dict[str, float]:
    """Hold rotor inertias that motors state, unless the caller says otherwise."""
    # A torque sensor behind the gear does not see the rotor: only motors whose torque was computed have one.
    plain = {name.partition("[")[0] for name in knowledge.names}
    labels = dict(zip(leg.joint_names, leg.joint_labels, strict=True))
    with_rotor = {
        leg.joint_names[joint]
        for term in terms
        if type(term) is Armature
        for joint in term.joint_indices(leg.joint_names, leg.joint_labels)
    }
    rotors = {
        f"Ia_{labels[joint]}": drive.armature
        for joint, drive in actuators.drives.items()
        if isinstance(drive, Motor) and drive.armature is not None and joint in with_rotor & computed
    }
    return {**{name: value for name, value in rotors.items() if name not in plain}, **knowledge.known}
