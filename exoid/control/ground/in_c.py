"""C of the law on the ground: its bodies as tables, and its inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike
from exoid.codegen import MOTION, ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.dialect import ABSURD
from exoid.codegen.templates import step_of
from exoid.control.c_description import describe
from exoid.control.friction import FrictionCompensation
from exoid.errors import NotSupportedError
from exoid.leg.model import configuration
from exoid.leg.reduction.planar import GRAVITY

from .model import BRAKE, GroundModel


def stance_in_c(
    model: GroundModel,
    friction: FrictionCompensation | None,
    rate: float,
    numbers: Mapping[str, tuple[ArrayLike, str]],
    dialect: Dialect,
) -> LawInC:
    """Describe the law: inputs of a state and a target, and a solver of quadratic programs that the caller gives."""
    if dialect.real != "double":
        raise NotSupportedError("the law on the ground in single precision", remedy='use precision="double"')
    soles, order = len(model.soles), ", ".join(model.soles)
    law = describe(
        model,
        friction,
        rate,
        dialect,
        equation=f"tau of min |dnu - dnu_d|^2 over torques and ground forces, {order}{{friction}}",
        step="    double springs[{{N}}], friction[{{N}}];\n{{friction}}\n    {{p}}_springs(in->q, springs);\n"
        "    for (j = 0; j < {{N}}; ++j) {\n        springs[j] += friction[j];\n    }\n"
        "    if (!{{p}}_stand(in, springs, tau)) { /* nothing touches, or no solution: the safe torque */\n"
        "        tau[0] = NAN;\n    }",
        calls=("springs",),
        inputs=(
            InputInC("pitch", "pitch of the torso, shoulders backwards, and its rate [rad, rad/s]", "reading", 2),
            InputInC("contact", f"0 in the air, 1 flat, 2 heel, 3 toe; {order}", "reading", soles),
            InputInC("share", "relative shares of the load", "reading", soles),
            InputInC("interaction", "torque of the wearer [N m]", "reading"),
            InputInC("push", "known force on the torso forward, up, and moment as the pitch [N, N, N m]", "reading", 3),
            InputInC("lean", "angle by which the ground rises forward [rad]", "reading", 1),
            *MOTION,
            InputInC("pitch_d", "desired pitch and its derivatives [rad, rad/s, rad/s^2]", "target", 3),
        ),
        tables={name: (np.minimum(values, ABSURD), what) for name, (values, what) in numbers.items()},
        damping=np.full(model.n, BRAKE),
    )
    helpers = f"{{% set S = {soles} %}}\n" + step_of("stance")
    return replace(law, tables=(*law.tables, *_bodies(model)), helpers=helpers, solver=True)


def _bodies(model: GroundModel) -> list[ArrayInC]:
    """Planar bodies at the zero pose: axes forward and up, and places from the origin of the torso's link."""
    tree, data, n = model.pinocchio, model.pinocchio.createData(), model.n
    plane, lateral = np.array([model.leg.plane.forward, model.leg.plane.up]), model.leg.plane.lateral
    zero = configuration(tree, np.zeros((1, 6 + n)))[0]
    pin.framesForwardKinematics(tree, data, zero)
    signs = -lateral @ pin.computeJointJacobians(tree, data, zero)[3:, 6:]
    parents = np.array([max(tree.parents[j] - 1, 0) for j in range(1, n + 2)])
    places = np.array([plane @ data.oMi[j].translation for j in range(1, n + 2)])
    turns, bodies = [data.oMi[j].rotation for j in range(1, n + 2)], [*tree.inertias][1:]
    levers = np.array([plane @ turn @ body.lever for turn, body in zip(turns, bodies, strict=True)])
    inertias = [lateral @ turn @ body.inertia @ turn.T @ lateral for turn, body in zip(turns, bodies, strict=True)]
    carries = np.zeros((n + 1, n))
    for body in range(1, n + 1):
        carries[body] = carries[parents[body]]
        carries[body, body - 1] = signs[body - 1]
    soles = [(tree.frames[frame].parentJoint - 1, frame, half) for frame, half in model.places.values()]
    middles = [plane @ data.oMf[frame].translation - places[body] for body, frame, _ in soles]
    return [
        ArrayInC("gravity", "upwards [m/s^2]", np.array([0.0, GRAVITY])),
        ArrayInC("hip", "point of the base's coordinates [m]", plane @ model.leg.hip),
        ArrayInC("parent", "parent of each body, the torso first", parents),
        ArrayInC("carries", "how joints turn each body, positive like the pitch", carries),
        ArrayInC("origin", "place of each body in its parent [m]", places - places[parents]),
        ArrayInC("mass", "[kg]", np.array([body.mass for body in bodies])),
        ArrayInC("com", "centre of mass [m]", levers),
        ArrayInC("inertia", "about it [kg m^2]", np.array(inertias)),
        ArrayInC("rotor", "[kg m^2]", model.armature),
        ArrayInC("sole_body", "body of each sole", np.array([body for body, _, _ in soles])),
        ArrayInC("sole", "middle of each sole [m]", np.array(middles)),
        ArrayInC("half", "half its length, 0 of a point [m]", np.array([half for _, _, half in soles])),
    ]
