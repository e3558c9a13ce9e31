"""Torque of payloads that are fixed to a leg: known, so that it stands beside the measured torque."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload

from .motion import BLOCK, Motion


def payload_parameters(leg: Leg, payloads: Sequence[Payload]) -> FloatArray:
    """Compute what payloads add to the parameters of a leg, which are linear in the inertias."""
    added = np.zeros((len(leg.bodies), 10))
    carried = [leg.bodies.index(link) for link in leg.link_names]
    named = (leg.link_labels, leg.link_names, leg.joint_labels, leg.joint_names)  # the last ones count first
    joints = {name: place for place, name in enumerate(leg.bodies)}
    joints |= {name: place for names in named for name, place in zip(names, carried, strict=True)}
    for payload in payloads:
        if payload.joint not in joints:
            what = f"a payload on {payload.joint!r}, which the leg does not have"
            remedy = f"its joints are {', '.join(leg.joint_names)}, its links {', '.join(leg.bodies)}"
            raise BadArgumentError(what, where=leg.description.name, remedy=remedy)
        inertia = payload.mass * payload.gyration**2 * np.eye(3)
        body = pin.Inertia(payload.mass, np.array(payload.position), inertia)
        added[joints[payload.joint]] += body.toDynamicParameters()
    return leg.reduction.parameters(added.ravel())


def payload_torque(leg: Leg, payloads: Sequence[Payload], motion: Motion) -> FloatArray:
    """Compute the joint torques that payloads take, W Δβ."""
    added = payload_parameters(leg, payloads)
    out = np.empty((len(motion.q), len(leg.row_names)))
    for start in range(0, len(out), BLOCK):
        rows = slice(start, start + BLOCK)
        part = motion.rows(rows)
        out[rows] = leg.regressor(part.q, part.v, part.a, part.torso) @ added
    return out
