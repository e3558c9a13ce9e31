"""Drives in an identification: torques from what they measure, terms of their motors, and rotors that are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from exoid.actuators import Actuators, Coupling, Drive, Motor, motor_terms
from exoid.actuators.constants import at_start, unknown_constants
from exoid.errors import BadArgumentError, NotSupportedError, within
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording, Recordings
from exoid.torques import DEFAULT_TERMS, Armature, Term

from .estimators import Estimator
from .estimators.by_name import name_of
from .group_rows import Group

Drives = Mapping[str, Drive | Coupling] | Actuators
"""Drive of each joint by its name, and couplings by any name; or actuators of the leg."""


class DrivenGroups(NamedTuple):
    """Groups of recordings with the torques of their drives."""

    groups: tuple[Group, ...]  # the groups
    actuators: tuple[Actuators, ...]  # actuators of the leg of each group; some of their constants may be unknown

    @staticmethod
    def of(groups: Sequence[Group], drives: Drives) -> DrivenGroups:
        """Compute torques before anything else looks at the recordings."""
        driven, mounted = [], []
        for group in groups:
            with within(group.name):
                actuators = Actuators.of(group.leg, drives)
                driven.append(group._replace(data=at_start(actuators).torques(group.data)))
                mounted.append(actuators)
        return DrivenGroups(tuple(driven), tuple(mounted))

    @property
    def unknown(self) -> Actuators | None:
        """Actuators of the only group if some of their constants are unknown."""
        return self.actuators[0] if len(self.actuators) == 1 and unknown_constants(self.actuators[0]) else None

    def refuse_unknown(
        self, estimator: Estimator, terms: Sequence[Term], delay: str | None, names: Sequence[str] = ()
    ) -> None:
        """Refuse what cannot act beside unknown constants of drives."""
        constants = [each.name for actuators in self.actuators for each in unknown_constants(actuators)]
        if not constants:
            return
        which = ", ".join(dict.fromkeys(constants))
        wrong = {
            "groups of recordings are fitted": len(self.groups) > 1 or self.groups[0].name != "",
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

    def default_terms(self) -> tuple[Term, ...]:
        """Add friction and rotors of coupled motors to the default terms, where torque was computed of these motors."""
        computed = self._computed
        couplings = self.actuators[0].couplings.values()
        used = [coupling for coupling in couplings if computed & set(coupling.joints)]
        return (*DEFAULT_TERMS, *(term for coupling in used for term in motor_terms(coupling)))

    @property
    def _computed(self) -> set[str]:
        """Joints of the first leg whose torque was computed of their drives in some recording."""
        group, actuators = self.groups[0], self.actuators[0]
        every = {*actuators.drives, *(joint for each in actuators.couplings.values() for joint in each.joints)}
        some = [group.data[0]] if isinstance(group.data, Recordings) else group.data  # of files, one is read
        names = {name for one in some if isinstance(one, Recording) for name in one.computed}
        labels = zip(group.leg.joint_names, group.leg.joint_labels, strict=True)
        return {joint for joint, label in labels if joint in every and names & {joint, label}}

    def known_rotors(self, terms: Sequence[Term], knowledge: PriorKnowledge) -> dict[str, float]:
        """Hold rotor inertias that motors state, unless the caller says otherwise."""
        # A torque sensor behind the gear does not see the rotor: only motors whose torque was computed have one.
        plain = {name.partition("[")[0] for name in knowledge.names}
        leg = self.groups[0].leg
        labels = dict(zip(leg.joint_names, leg.joint_labels, strict=True))
        with_rotor = {
            leg.joint_names[joint]
            for term in terms
            if type(term) is Armature
            for joint in term.joint_indices(leg.joint_names, leg.joint_labels)
        }
        rotors = {
            f"Ia_{labels[joint]}": drive.armature
            for joint, drive in self.actuators[0].drives.items()
            if isinstance(drive, Motor) and drive.armature is not None and joint in with_rotor & self._computed
        }
        return {**{name: value for name, value in rotors.items() if name not in plain}, **knowledge.known}
