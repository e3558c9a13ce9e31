"""Pinocchio model of the selected joints of a URDF, with all other joints locked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError, nearest

from .description import Description

NEGATIVE = 1e-6
"""Largest negative principal inertia, over the largest positive one, that counts as rounding."""


def build_model(
    description: Description, joints: Sequence[str] | None, locked: Mapping[str, float], dependent: Sequence[str] = ()
) -> pin.Model:
    """Build the model whose only joints are ``joints`` and ``dependent`` ones of loops.

    Links behind locked joints are lumped into their parents.
    """
    full = _parse(description)
    single = [full.names[j] for j in range(1, full.njoints) if full.nvs[j] == 1]
    if joints is not None and (isinstance(joints, str) or not joints or not all(isinstance(j, str) for j in joints)):
        raise BadArgumentError(f"joints must be names, not {joints!r}", remedy="pass e.g. joints=('hip', 'knee')")
    free = (name for name in single if name not in locked and name not in dependent)
    moving = list(free if joints is None else joints)
    for name in (*moving, *locked, *dependent):
        if name not in single:
            raise _missing(name, single, full, description)
    if sorted(moving, key=single.index) != moving or len(set(moving)) != len(moving):
        raise BadArgumentError(
            f"joints {tuple(moving)} are not in the order of the chain",
            where=description.name,
            remedy=f"name each once, from the torso outwards: {tuple(sorted(set(moving), key=single.index))}",
        )
    if not moving:
        raise BadArgumentError("no joint moves", where=description.name, remedy="name joints of one degree of freedom")
    if followed := sorted(set(moving) & set(dependent)):
        what = f"{followed} are dependent joints of loops, and cannot be chosen"
        raise BadArgumentError(what, joints=tuple(followed), where=description.name, remedy="leave them out of joints")
    moving = sorted((*moving, *dependent), key=single.index)
    if set(moving) & set(locked):
        raise BadArgumentError(f"{sorted(set(moving) & set(locked))} both move and are locked", where=description.name)
    _refuse_free_joints(full, moving, description)
    positions = np.zeros((1, full.nv))
    for name, value in locked.items():
        try:
            positions[0, full.joints[full.getJointId(name)].idx_v] = value
        except (TypeError, ValueError):
            raise BadArgumentError(
                f"joint {name!r} is locked at {value!r}, which is no number", where=description.name
            ) from None
    if not np.isfinite(positions).all():
        raise BadArgumentError(f"a locked position is not finite: {dict(locked)}", where=description.name)
    fixed = [j for j in range(1, full.njoints) if full.names[j] not in moving]
    model = pin.buildReducedModel(full, fixed, configuration(full, positions)[0])
    _check_inertias(model, description)
    return model


def configuration(model: pin.Model, q: FloatArray) -> FloatArray:
    """Convert joint angles to Pinocchio's configuration, in which a continuous joint is (cos, sin)."""
    if model.nq == model.nv:
        return q
    out = np.tile(pin.neutral(model), (len(q), 1))
    for joint in (joint for joint in model.joints[1:] if joint.nv == 1):
        angle = q[:, joint.idx_v]
        of_joint = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
        out[:, joint.idx_q : joint.idx_q + joint.nq] = np.stack(of_joint, axis=1)
    return out


def joint_axis(joint: pin.JointModel) -> FloatArray:
    """Find the motion vector of a unit rate of a joint in its own frame."""
    if joint.nv != 1:
        return np.zeros(6)
    data = joint.createData()
    joint.calc(data, np.eye(joint.nq)[0] if joint.nq > 1 else np.zeros(1))  # (cos, sin) of a continuous joint
    return np.asarray(data.S, dtype=np.float64).reshape(6)


def position_limits(model: pin.Model) -> FloatArray:
    """Smallest and largest angle of each joint [rad or m], (2, n); infinite where it has no limit."""
    joints = [joint for joint in model.joints[1:] if joint.nv == 1]
    limits = np.array([[x[j.idx_q] for j in joints] for x in (model.lowerPositionLimit, model.upperPositionLimit)])
    # continuous joints have no limits, and exporters of CAD programs write 0 for those that nobody gave
    free = [joint.nq == 2 for joint in joints] | (limits[0] == limits[1])
    return np.where(free, [[-np.inf], [np.inf]], limits)


def dynamic_parameters(model: pin.Model, *, root: bool = False) -> FloatArray:
    """Stack π = [m, mc, I] of the moving links in Pinocchio's order, with I about the joint frame."""
    return np.concatenate([model.inertias[j].toDynamicParameters() for j in range(1 - root, model.njoints)])


def with_dynamic_parameters(model: pin.Model, parameters: FloatArray) -> pin.Model:
    """Copy a model with other inertial parameters."""
    copy = pin.Model(model)
    bodies = parameters.reshape(-1, 10)
    for j, values in enumerate(bodies, start=model.njoints - len(bodies)):
        copy.inertias[j] = pin.Inertia.FromDynamicParameters(values)
    return copy


def _parse(description: Description) -> pin.Model:
    try:
        model = pin.buildModelFromXML(description.plain)
    except Exception as error:  # Pinocchio raises whatever its URDF parser throws
        raise UnreadableInputError(
            f"Pinocchio cannot read this URDF ({error})",
            where=description.name,
            remedy="check it with a URDF validator; every joint needs <parent>, <child> and a known type",
        ) from error
    taken: set[str] = set()
    for number, frame in enumerate(model.frames):  # a link may be named like a joint, but locking needs distinct frames
        if frame.name in taken:
            frame.name = f"{frame.name} {number}"
        taken.add(frame.name)
    return model


def _refuse_free_joints(model: pin.Model, moving: Sequence[str], description: Description) -> None:
    """Refuse joints of several degrees of freedom below a moving joint: locked, their links would move with it."""
    for j in range(1, model.njoints):
        above = [name for name in (model.names[k] for k in list(model.supports[j])[1:-1]) if name in moving]
        if model.nvs[j] != 1 and above:
            raise NotSupportedError(
                f"joint {model.names[j]!r} has {model.nvs[j]} degrees of freedom and is below the moving joint "
                f"{above[-1]!r}: its links would count as fixed to it",
                where=description.name,
                remedy="make it fixed in the URDF, split it into joints of one degree of freedom, or choose joints "
                "that are not above it",
            )


def _missing(name: str, single: list[str], model: pin.Model, description: Description) -> BadArgumentError:
    if name in list(model.names):
        what = f"joint {name!r} has {model.nvs[model.getJointId(name)]} degrees of freedom"
        return BadArgumentError(what, where=description.name, remedy="use joints of one degree of freedom")
    return BadArgumentError(
        f"no moving joint {name!r}",
        joints=(name,),
        where=description.name,
        remedy=f"{nearest(name, single)}it has {', '.join(single) or 'none'}",
    )


def _check_inertias(model: pin.Model, description: Description) -> None:
    for j in range(1, model.njoints):
        inertia = model.inertias[j]
        link = description.child_links.get(model.names[j], model.names[j])
        place = f"{description.name}, link {link!r}"
        if inertia.mass <= 0.0:
            raise UnreadableInputError(
                f"joint {model.names[j]!r} moves a link of mass {inertia.mass:g} kg: no <inertial>?",
                where=place,
                remedy="add an <inertial> with mass and inertia, an estimate from CAD or a scale is enough to start",
            )
        smallest, *_, largest = np.linalg.eigvalsh(inertia.inertia)
        if smallest < -NEGATIVE * max(largest, NEGATIVE):
            raise UnreadableInputError(
                f"a principal inertia is negative ({smallest:.3g} kg·m²), which no body has",
                where=place,
                remedy="check the signs in <inertia>, and that it is about the centre of mass",
            )
