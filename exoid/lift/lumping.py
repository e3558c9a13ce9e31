"""Which links of a URDF make up each moving body, and how an identified body is shared out among them again.

Fixed and locked joints lump links together: the body of a joint is the link it carries and all that is fixed to it. The
parts that are fixed keep their inertia, and the link itself gets what is left of the body. Where nothing possible is
left, or the link has no inertia of its own, all parts are moved by the one affine map that makes the old body the new
one, P → A P Aᵀ: each part stays possible, and their sum is exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.rewriting import read_inertials

from .pseudo_inertia import congruence, link_parameters, made_possible, margins, pseudo_inertias, upper_factors

ROOM = 1e-6
"""Smallest margin with which what is left of a body counts as possible."""

AGREEMENT = 1e-9
"""Relative difference between a body and the sum of its parts that is rounding."""


class LinkInertia(NamedTuple):
    """A link with inertia.

    Attributes:
        link: Its name.
        placement: Its frame in the joint frame of the body.
        parameters: π about the joint frame of the body, (10,).
    """

    link: str
    placement: pin.SE3
    parameters: FloatArray


def share_out(leg: Leg, bodies: FloatArray) -> dict[str, FloatArray]:
    """Share bodies out among the links they are made of.

    Args:
        leg: The leg, with the URDF's inertias.
        bodies: π of each moving body about its joint frame, (n, 10); possible.

    Returns:
        π about the link frame, (10,), of each link whose inertia changes.

    Raises:
        ExoidError: The bodies of the leg are not the sum of the links in its URDF.
    """
    shares: dict[str, FloatArray] = {}
    for joint, (own, parts, body) in enumerate(zip(leg.link_names, _parts(leg), bodies, strict=True), start=1):
        total = np.sum([part.parameters for part in parts], axis=0)
        given = leg.model.inertias[joint].toDynamicParameters()
        if not np.allclose(total, given, rtol=0.0, atol=AGREEMENT * np.abs(given).max()):
            raise ExoidError(
                f"the links at joint {leg.joint_names[joint - 1]!r} do not add up to its body",
                where=leg.description.name,
                remedy="name links and joints differently, so that each name is there once",
            )
        changed = _left_over(own, parts, body) or _moved_alike(parts, body)
        for part in changed:
            inverse = congruence(part.placement.inverse().homogeneous[None])[0]
            shares[part.link] = inverse @ part.parameters
    return shares


def _left_over(own: str, parts: list[LinkInertia], body: FloatArray) -> list[LinkInertia]:
    """Give the link itself what the fixed parts leave of the body; nothing where that is impossible."""
    mine = [part for part in parts if part.link == own and part.parameters[0] > 0.0]
    fixed = [part.parameters for part in parts if part.link != own]
    left = body - np.sum(fixed, axis=0) if fixed else body
    if mine and (not fixed or margins(left)[0] > ROOM):
        return [mine[0]._replace(parameters=left)]
    return []


def _moved_alike(parts: list[LinkInertia], body: FloatArray) -> list[LinkInertia]:
    heavy = [part for part in parts if part.parameters[0] > 0.0]
    before = pseudo_inertias(made_possible(np.concatenate([part.parameters for part in heavy])))
    old, new = upper_factors(before.sum(axis=0)[None])[0], upper_factors(pseudo_inertias(body))[0]
    A = np.linalg.solve(old.T, new.T).T
    after = link_parameters(A @ before @ A.T).reshape(-1, 10)
    return [part._replace(parameters=parameters) for part, parameters in zip(heavy, after, strict=True)]


def _parts(leg: Leg) -> list[list[LinkInertia]]:
    """Links of each body that have an inertia, as Pinocchio's frames place them."""
    inertials = read_inertials(leg.description)
    parts: list[list[LinkInertia]] = [[] for _ in leg.joint_names]
    for frame in leg.model.frames:
        link = (
            frame.name if frame.name in inertials else frame.name.rpartition(" ")[0]
        )  # as building may have renamed it
        if frame.type == pin.FrameType.BODY and frame.parentJoint > 0 and link in inertials:
            about_joint = congruence(frame.placement.homogeneous[None])[0] @ inertials[link]
            parts[frame.parentJoint - 1].append(LinkInertia(link, frame.placement, about_joint))
    return parts
