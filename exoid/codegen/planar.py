"""Bodies of a planar machine behind a free base as tables for C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.model import configuration
from exoid.leg.reduction import Plane
from exoid.leg.reduction.planar import GRAVITY

from .law_in_c import ArrayInC


def planar_bodies(
    leg: Leg, tree: pin.Model, rotors: FloatArray, soles: Mapping[str, tuple[int, float]]
) -> list[ArrayInC]:
    """Write planar bodies behind a free base at the zero pose, and their soles: frame and half the length of each."""
    data, n = tree.createData(), len(leg.joint_names)
    plane, lateral = np.array([leg.plane.forward, leg.plane.up]), leg.plane.lateral
    zero = configuration(tree, np.zeros((1, 6 + n)))[0]
    pin.framesForwardKinematics(tree, data, zero)
    signs = -lateral @ pin.computeJointJacobians(tree, data, zero)[3:, 6:]
    parents = np.array([max(tree.parents[j] - 1, 0) for j in range(1, n + 2)])
    places = np.array([plane @ data.oMi[j].translation for j in range(1, n + 2)])
    carries = np.zeros((n + 1, n))
    for body in range(1, n + 1):
        carries[body] = carries[parents[body]]
        carries[body, body - 1] = signs[body - 1]
    bodies = [tree.frames[frame].parentJoint - 1 for frame, _ in soles.values()]
    middles = [plane @ data.oMf[f].translation - places[b] for b, (f, _) in zip(bodies, soles.values(), strict=True)]
    return [
        ArrayInC("gravity", "upwards [m/s^2]", np.array([0.0, GRAVITY])),
        ArrayInC("hip", "point of the base's coordinates [m]", plane @ leg.hip),
        ArrayInC("parent", "parent of each body, the torso first", parents),
        ArrayInC("carries", "how joints turn each body, positive like the pitch", carries),
        ArrayInC("origin", "place of each body in its parent [m]", places - places[parents]),
        *masses(leg.plane, turns_at_zero(tree), [*tree.inertias][1:], rotors),
        ArrayInC("sole_body", "body of each sole", np.array(bodies)),
        ArrayInC("sole", "middle of each sole [m]", np.array(middles)),
        ArrayInC("half", "half its length, 0 of a point [m]", np.array([half for _, half in soles.values()])),
    ]


def turns_at_zero(tree: pin.Model) -> list[FloatArray]:
    """Rotation of each body at the zero pose, the torso first."""
    data = tree.createData()
    pin.forwardKinematics(tree, data, configuration(tree, np.zeros((1, tree.nv)))[0])
    return [data.oMi[j].rotation.copy() for j in range(1, tree.njoints)]


def masses(
    plane: Plane, turns: Sequence[FloatArray], bodies: Sequence[pin.Inertia], rotors: FloatArray, name: str = ""
) -> list[ArrayInC]:
    """Planar masses of bodies, whose axes are turned at the zero pose."""
    own, ahead = [*zip(turns, bodies, strict=True)], np.array([plane.forward, plane.up])
    inertias = [plane.lateral @ turn @ body.inertia @ turn.T @ plane.lateral for turn, body in own]
    return [
        ArrayInC(f"{name}mass", "[kg]", np.array([body.mass for body in bodies])),
        ArrayInC(f"{name}com", "centre of mass [m]", np.array([ahead @ turn @ body.lever for turn, body in own])),
        ArrayInC(f"{name}inertia", "about it [kg m^2]", np.array(inertias)),
        ArrayInC(f"{name}rotor", "[kg m^2]", np.array(rotors, dtype=np.float64)),
    ]


def planar_parameters(plane: Plane, turn: FloatArray) -> FloatArray:
    """Mass, mass moments forward and up, and inertia of a link from Pinocchio's ten parameters, (4, 10)."""
    out, (x, y, z) = np.zeros((4, 10)), turn.T @ plane.lateral
    out[0, 0] = 1.0
    out[1:3, 1:4] = np.array([plane.forward, plane.up]) @ turn
    out[3, 4:] = x * x, 2.0 * x * y, y * y, 2.0 * x * z, 2.0 * y * z, z * z
    return out
