"""C of the law on the ground: its inputs and tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from exoid._typing import ArrayLike
from exoid.codegen import MOTION, Dialect, InputInC, LawInC
from exoid.codegen.dialect import ABSURD
from exoid.codegen.planar import planar_bodies
from exoid.codegen.templates import sized
from exoid.control.c_description import describe
from exoid.control.friction import FrictionCompensation

from .model import BRAKE, GroundModel

STEP = """\
    double springs[{{N}}], friction[{{N}}];
{{friction}}
    {{p}}_springs(in->q, springs);
    for (j = 0; j < {{N}}; ++j) {
        springs[j] += friction[j];
    }
    if (!{{p}}_stand(in, in->contact, in->share, springs, tau)) { /* nothing touches, or no solution: the safe torque */
        tau[0] = NAN;
    }"""


def stance_in_c(
    model: GroundModel,
    friction: FrictionCompensation | None,
    rate: float,
    numbers: Mapping[str, tuple[ArrayLike, str]],
    dialect: Dialect,
    step: str = STEP,
) -> LawInC:
    """Describe the law: inputs of a state and a target, and a solver of quadratic programs that the caller gives."""
    dialect.require_double("the law on the ground")
    soles, order = len(model.soles), ", ".join(model.soles)
    law = describe(
        model,
        friction,
        rate,
        dialect,
        equation=f"tau of min |dnu - dnu_d|^2 over torques and ground forces, {order}{{friction}}",
        step=step,
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
    return replace(
        law,
        tables=(*law.tables, *planar_bodies(model.leg, model.pinocchio, model.armature, model.places)),
        helpers=sized("stance", S=soles),
        solver=True,
    )
