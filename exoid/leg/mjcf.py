"""MuJoCo's model file (MJCF) of the joints of a leg: MuJoCo writes it, and all digits of its numbers are put in."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from lxml import etree

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.tools.extras import install_extra

from .description import LARGEST_NUMBER
from .model import joint_axis


class JointNumbers(NamedTuple):
    """Numbers of the joints beside the rigid bodies, (n,) each."""

    armature: FloatArray  # rotor inertia at the joint [kg·m²]
    damping: FloatArray  # viscous friction [N·m·s/rad]
    friction: FloatArray  # coulomb friction [N·m], MuJoCo's `frictionloss`
    lower: FloatArray  # lower limit of the position [rad or m]
    upper: FloatArray  # upper limit
    effort: FloatArray  # largest torque of the motor [N·m]


def require_mujoco() -> Any:  # noqa: ANN401 - a module
    """Import MuJoCo, an extra of exoid."""
    try:
        import mujoco  # noqa: PLC0415 - an extra
    except ImportError:
        raise NotSupportedError("MuJoCo is not installed", remedy=install_extra("ground")) from None
    return mujoco


def to_mjcf(model: pin.Model, links: tuple[str, ...], numbers: JointNumbers, name: str) -> str:
    """Write the joints of a model on a base that does not move, with a motor at each joint."""
    mujoco = require_mujoco()
    spec = mujoco.MjSpec()
    spec.modelname, spec.compiler.degree = name, False
    spec.option.gravity = model.gravity.linear
    bodies, axes = [spec.worldbody], joint_axes(model)
    for j, link in enumerate(links, start=1):
        body = bodies[model.parents[j]].add_body(name=link)
        set_inertia(body, model.inertias[j])
        turns = bool(axes[j - 1, 3:].any())
        kind = mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE
        body.add_joint(name=model.names[j], type=kind, axis=axes[j - 1, 3:] if turns else axes[j - 1, :3])
        motor = spec.add_actuator(name=model.names[j], target=model.names[j], trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
        bodies.append(body)
    for j in range(1, model.njoints):
        _draw(bodies[j], mujoco, model, j)
    try:
        spec.compile()
    except ValueError as error:
        raise BadArgumentError(
            f"MuJoCo refuses these bodies ({error})",
            where=name,
            remedy="check masses and moments of inertia: no link can have those given",
        ) from error
    return _with_all_digits(spec.to_xml(), model, links, axes, numbers)


def joint_axes(model: pin.Model) -> FloatArray:
    """Find the axis of each joint in the frame of its body."""
    return np.array([joint_axis(model.joints[j]) for j in range(1, model.njoints)])


def set_inertia(body: Any, inertia: pin.Inertia) -> None:  # noqa: ANN401
    """Give a body of MuJoCo its inertia."""
    body.explicitinertial, body.mass, body.ipos = True, inertia.mass, inertia.lever
    body.fullinertia = full_inertia(inertia)


def full_inertia(inertia: pin.Inertia) -> FloatArray:
    """Arrange an inertia as MuJoCo's ``fullinertia``."""
    matrix = inertia.inertia
    return np.array([matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[0, 1], matrix[0, 2], matrix[1, 2]])


def _draw(body: Any, mujoco: Any, model: pin.Model, j: int) -> None:  # noqa: ANN401
    """Show a link as rods to the joints that it carries, or to beyond its centre of mass."""
    carried = [model.jointPlacements[k].translation for k in range(j + 1, model.njoints) if model.parents[k] == j]
    for end in carried or [2.0 * model.inertias[j].lever]:
        if end.any():
            # Radius of the rods that show the links [m]; they have no mass and touch nothing
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=[0.0, 0.0, 0.0, *end],
                size=[0.015, 0.0, 0.0],
                mass=0.0,
                contype=0,
                conaffinity=0,
            )


def _with_all_digits(
    xml: str, model: pin.Model, links: tuple[str, ...], axes: FloatArray, numbers: JointNumbers
) -> str:
    """Put in the numbers with all digits, of which MuJoCo writes six."""
    root = etree.fromstring(xml.encode())
    bodies = {body.get("name"): body for body in root.iter("body")}
    for k, link in enumerate(links):
        body, place, inertia = bodies[link], model.jointPlacements[k + 1], model.inertias[k + 1]
        x, y, z, w = pin.Quaternion(place.rotation).coeffs()
        body.set("pos", _text(place.translation))
        body.set("quat", _text([w, x, y, z]))
        inertial, joint = body.find("inertial"), body.find("joint")
        assert inertial is not None
        assert joint is not None
        inertial.attrib.clear()
        inertial.set("pos", _text(inertia.lever))
        inertial.set("mass", repr(float(inertia.mass)))
        inertial.set("fullinertia", _text(full_inertia(inertia)))
        joint.set("axis", _text(axes[k, 3:] if axes[k, 3:].any() else axes[k, :3]))
        said = {"armature": numbers.armature, "damping": numbers.damping, "frictionloss": numbers.friction}
        for attribute, values in said.items():
            if values[k]:
                joint.set(attribute, repr(float(values[k])))
        if max(abs(numbers.lower[k]), abs(numbers.upper[k])) < LARGEST_NUMBER:
            joint.set("range", _text([numbers.lower[k], numbers.upper[k]]))
    for motor in root.iter("motor", "general"):
        effort = float(numbers.effort[[model.names[k + 1] for k in range(len(links))].index(motor.get("joint", ""))])
        if 0.0 < effort < LARGEST_NUMBER:
            motor.set("ctrlrange", _text([-effort, effort]))
    etree.indent(root)
    return etree.tostring(root, encoding="unicode") + "\n"


def _text(values: ArrayLike) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values, dtype=np.float64))
