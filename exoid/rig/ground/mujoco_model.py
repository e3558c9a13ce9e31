"""MuJoCo's model of a machine on flat ground."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.link_frames import link_frame
from exoid.leg.model import joint_axis
from exoid.tools.extras import require_mujoco

from .plant import GroundPlant, Sole

SOLE_SOLREF = [0.015, 1.0]
"""Time constant [s] and damping of a rubber sole: two to three times the weight at touch-down."""

SOLE_SOLIMP = (0.95, 0.99, 0.001, 0.5, 2.0)
"""Impedance of a rubber sole."""


def build_mujoco_model(plant: GroundPlant, step: float) -> Any:  # noqa: ANN401 - MuJoCo's class
    """Build MuJoCo's model of a machine: joints of the base, one body for each joint, spheres under the soles."""
    # The bodies are in Pinocchio's order: body 1 is the root link, body j + 1 that of joint j.
    mujoco = require_mujoco()
    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep, option.gravity = step, plant.gravity
    option.integrator, option.solver = mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtSolver.mjSOL_NEWTON
    # impedance of friction over that of the normal force: the larger, the less a loaded foot creeps
    option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 100.0
    option.tolerance, option.iterations = 1e-14, 100
    option.disableflags = mujoco.mjtDisableBit.mjDSBL_AUTORESET  # a state that diverges stays, and is refused
    spec.compiler.degree = False
    bodies = _add_bodies(spec, mujoco, plant)
    spec.worldbody.add_geom(name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50.0, 50.0, 1.0])
    x, y, z, w = pin.Quaternion(np.column_stack(plant.plane)).coeffs()
    box = {"type": mujoco.mjtGeom.mjGEOM_BOX, "quat": [w, x, y, z], "condim": 3}
    for block in plant.blocks:
        middle = 0.5 * (block.start + block.stop) * plant.plane.forward + 0.5 * block.height * plant.plane.up
        size = 0.5 * np.array([block.stop - block.start, 100.0, block.height])
        geom = spec.worldbody.add_geom(size=size, pos=middle, **box)
        if block.friction is not None:  # it overrides that of the soles
            geom.friction, geom.priority = [block.friction, 0.0, 0.0], 2
            geom.solref, geom.solimp = SOLE_SOLREF, SOLE_SOLIMP
    for link, sole in plant.soles.items():
        _add_sole(bodies, mujoco, plant, link, sole)
    try:
        return spec.compile()
    except ValueError as error:
        raise BadArgumentError(
            f"MuJoCo cannot simulate these bodies ({error})",
            where=plant.leg.description.name,
            remedy="check masses and moments of inertia: no link can have those given",
        ) from error


def geometry_name(link: str, number: int) -> str:
    """Name a sphere of a sole."""
    return f"exoid sole {number} {link}"


def _add_bodies(spec: Any, mujoco: Any, plant: GroundPlant) -> list[Any]:  # noqa: ANN401
    model, kinds = plant.leg.model, mujoco.mjtJoint
    torso = spec.worldbody.add_body(name="exoid torso")
    bodies, data = [torso], model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    _set_inertia(torso, model.inertias[0], plant, np.eye(3))
    if plant.is_planar:
        axes = plant.plane.forward, plant.plane.up, -plant.plane.lateral
        for name, kind, axis in zip(
            ("forward", "up", "pitch"), (kinds.mjJNT_SLIDE,) * 2 + (kinds.mjJNT_HINGE,), axes, strict=True
        ):
            torso.add_joint(name=f"exoid base {name}", type=kind, axis=axis)
    else:
        torso.add_freejoint(name="exoid base free")
    for j in range(1, model.njoints):
        place = model.jointPlacements[j]
        x, y, z, w = pin.Quaternion(place.rotation).coeffs()
        body = bodies[model.parents[j]].add_body(name=f"exoid {j}", pos=place.translation, quat=[w, x, y, z])
        _set_inertia(body, model.inertias[j], plant, data.oMi[j].rotation)
        twist = joint_axis(model.joints[j])
        turns = bool(twist[3:].any())
        body.add_joint(
            name=model.names[j],
            type=kinds.mjJNT_HINGE if turns else kinds.mjJNT_SLIDE,
            axis=twist[3:] if turns else twist[:3],
            armature=plant.armature[j - 1],
        )
        bodies.append(body)
    return bodies


def _set_inertia(body: Any, inertia: pin.Inertia, plant: GroundPlant, rotation: FloatArray) -> None:  # noqa: ANN401
    """Give a body its inertia; in a plane only that about the lateral axis acts, and the others are set equal to it."""
    matrix = inertia.inertia
    if plant.is_planar:
        lateral = rotation.T @ plant.plane.lateral
        matrix = float(lateral @ matrix @ lateral) * np.eye(3)
    body.explicitinertial, body.mass, body.ipos = True, inertia.mass, inertia.lever
    body.fullinertia = [matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[0, 1], matrix[0, 2], matrix[1, 2]]


def _add_sole(bodies: list[Any], mujoco: Any, plant: GroundPlant, link: str, sole: Sole) -> None:  # noqa: ANN401
    joint, placement = link_frame(plant.leg.model, plant.leg.description, link)
    for number, point in enumerate(sole.points + np.array([0.0, 0.0, sole.radius])):
        bodies[joint + 1].add_geom(
            name=geometry_name(link, number),
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[sole.radius, 0.0, 0.0],
            pos=placement.act(point),
            friction=[plant.ground_friction, 0.0, 0.0],
            priority=1,  # friction and stiffness of the sole, not of the ground
            condim=3,
            contype=2,  # touches the ground, but no other sole
            conaffinity=1,
            solref=SOLE_SOLREF,
            solimp=SOLE_SOLIMP,
        )
