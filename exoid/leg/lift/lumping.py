"""Lumping: distributes the inertia of an identified body among the links of the URDF that form it.

Fixed and locked joints lump links into one body: the link that a joint carries and all links fixed to it. The fixed
links keep their inertia, and the carried link gets the rest of the body. This rest may be physically inconsistent or of
another size, or the link may have no inertia in the URDF. Then one affine map P → A P Aᵀ from the old body to the new
one changes all links. Each link stays consistent, and their sum is exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.leg.rewriting import read_inertials

from .pseudo_inertia import congruence, link_parameters, make_consistent, margins, pseudo_inertias, upper_factors

MASS_FACTOR = 5.0
"""Usual limit of the mass of a link over its mass in the URDF, and of the inverse.

A leg with its wearer weighs up to five times as much as the exoskeleton alone. Links of noisy estimates stay within a
factor of 3 where the pull towards the URDF's own links is the usual one.
"""


class LinkInertia(NamedTuple):
    """A link with inertia."""

    link: str  # name of the link
    placement: pin.SE3  # link frame in the joint frame of the body
    parameters: FloatArray  # π about the joint frame of the body, (10,)


def distribute_bodies(leg: Leg, bodies: FloatArray, mass_factor: float = np.inf) -> dict[str, FloatArray]:
    """Distribute the inertias of bodies among the links that form them."""
    shares: dict[str, FloatArray] = {}
    every = zip(leg.bodies, _parts(leg), leg.link_parameters.reshape(-1, 10), bodies, strict=True)
    for own, parts, given, body in every:
        total = np.sum([part.parameters for part in parts], axis=0)
        # Largest relative difference between a body and the sum of its links
        if not np.allclose(total, given, rtol=0.0, atol=1e-9 * np.abs(given).max()):
            raise NotSupportedError(
                f"the links fixed to {own!r} do not sum to its body",
                where=leg.description.name,
                remedy="rename links and joints so that each name occurs once",
            )
        changed = _rest_of(own, parts, body, mass_factor) or _mapped(parts, body)
        for part in changed:
            inverse = congruence(part.placement.inverse().homogeneous[None])[0]
            shares[part.link] = inverse @ part.parameters
    return shares


def _rest_of(own: str, parts: list[LinkInertia], body: FloatArray, mass_factor: float) -> list[LinkInertia]:
    """The carried link with the body less the fixed links; empty if that is not consistent or its mass far off."""
    mine = [part for part in parts if part.link == own and part.parameters[0] > 0.0]
    fixed = [part.parameters for part in parts if part.link != own]
    rest = body - np.sum(fixed, axis=0) if fixed else body
    if not mine:
        return []
    share = rest[0] / mine[0].parameters[0]
    # 1e-6: smallest margin of the rest of a body that counts as consistent
    if fixed and not (margins(rest)[0] > 1e-6 and 1.0 / mass_factor <= share <= mass_factor):
        return []
    return [mine[0]._replace(parameters=rest)]


def _mapped(parts: list[LinkInertia], body: FloatArray) -> list[LinkInertia]:
    """All links under the affine map from their sum to the body."""
    heavy = [part for part in parts if part.parameters[0] > 0.0]
    before = pseudo_inertias(make_consistent(np.concatenate([part.parameters for part in heavy])))
    old, new = upper_factors(before.sum(axis=0)[None])[0], upper_factors(pseudo_inertias(body))[0]
    A = np.linalg.solve(old.T, new.T).T
    after = link_parameters(A @ before @ A.T).reshape(-1, 10)
    return [part._replace(parameters=parameters) for part, parameters in zip(heavy, after, strict=True)]


def _parts(leg: Leg) -> list[list[LinkInertia]]:
    """Links of each body that have an inertia, placed by Pinocchio's frames."""
    inertials = read_inertials(leg.description)
    parts: list[list[LinkInertia]] = [[] for _ in leg.bodies]
    first = leg.model.njoints - len(parts)  # the root link is a body only if it floats
    for frame in leg.model.frames:
        renamed = frame.name not in inertials  # by build_model
        link = frame.name.rpartition(" ")[0] if renamed else frame.name
        if frame.type == pin.FrameType.BODY and frame.parentJoint >= first and link in inertials:
            about_joint = congruence(frame.placement.homogeneous[None])[0] @ inertials[link]
            parts[frame.parentJoint - first].append(LinkInertia(link, frame.placement, about_joint))
    return parts


class MassChange(NamedTuple):
    """Mass of a link, before and after."""

    link: str  # name of the link
    before: float  # mass in the URDF [kg]
    after: float  # new mass [kg]

    @property
    def factor(self) -> float:
        """New mass over that in the URDF."""
        return self.after / self.before

    @property
    def change(self) -> float:
        """Factor of the change, at least 1 whether the link became heavier or lighter."""
        return max(self.factor, 1.0 / self.factor)


def refuse_mass_changes(masses: Sequence[MassChange], mass_factor: float, name: str) -> None:
    """Refuse links whose masses are far from those in the URDF."""
    beyond = [mass for mass in masses if not mass.change <= mass_factor]
    if not beyond:
        return
    what = ", ".join(f"{m.link} would weigh {m.after:.3g} kg instead of {m.before:.3g} kg" for m in beyond)
    allowed = f"{math.ceil(1.01 * max(mass.change for mass in beyond))}"
    raise NotIdentifiableError(
        f"{what}: beyond a factor of {mass_factor:g}",
        where=name,
        remedy="correct the masses in the URDF, identify with prior=Prior.from_leg(leg) or from a better motion, or "
        f"allow it by mass_factor={allowed} (--mass-factor {allowed})",
    )
