"""Adaptive control in C: regressor, composite adaptation and projection on the cone of possible parameters."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, ArrayInC, LawInC
from exoid.control.adaptive import LIMITED, Adaptive
from exoid.control.friction import WIDTH
from exoid.control.parameter_cone import INSIDE
from exoid.control.torque_prediction import SETTLED, SLIDING, TorquePrediction
from exoid.errors import ExoidError
from exoid.leg.reduction.planar import GRAVITY

from .forms import register_law_in_c
from .leg import leg_in_c
from .motion_filter import filter_tables
from .steps import step_of

LEAST_STEPS, STEPS_PER_PARAMETER = 30, 2
"""Largest number of steps of the projection in one sample, without and for each parameter.

One or two are enough in most samples. Recorded gaits took up to 25 steps, random jumps of the state 45 with 20
parameters and 64 with 29.
"""

MOTION_MEMORY = {
    "q": "filtered angles [rad]",
    "rate": "their rate of change [rad/s]",
    "v": "filtered velocities [rad/s]",
    "a": "their rate of change: accelerations [rad/s^2]",
    "q_read": "last reading of the angles [rad]",
    "v_read": "last reading of the velocities [rad/s]",
    "torque": "filtered torque [N m]",
    "torque_rate": "its rate of change [N m/s]",
}
"""Memory of the filters of composite adaptation."""


@register_law_in_c(Adaptive)
def adaptive_in_c(law: Adaptive, dialect: Dialect) -> LawInC:
    """Describe adaptive control. Where it begins again after a fault, it begins with the initial parameters.

    Args:
        law: The law.
        dialect: Double precision, which the metric of the parameters needs.

    Returns:
        The law for C.

    Raises:
        ExoidError: Single precision, or the leg or a term of the model has no form in C.
    """
    if dialect.real != "double":
        raise ExoidError("adaptive control in float", remedy="use double precision: its metric is nearly singular")
    linear, leg = law.model, law.model.model.leg
    if leg.chain is None:
        raise ExoidError(
            "only a planar chain of revolute joints under gravity of 9.81 m/s² has closed equations to write in C",
            where=leg.description.name,
            remedy="choose joints whose axes are horizontal and parallel (joints=...)",
        )
    if linear.model.others:
        names = ", ".join(sorted({type(other.term).__name__ for other in linear.model.others}))
        raise ExoidError(
            f"{names} is not adapted, and has no form in adaptive control in C",
            remedy="use springs, offsets, rotors, Coulomb and viscous friction",
        )
    P = len(law.names)
    values = {
        "{{count}}": str(P),
        "{{generators}}": str(law.cone.generators.shape[1]),
        "{{iterations}}": str(LEAST_STEPS + STEPS_PER_PARAMETER * P),
        "{{columns}}": _columns(law, dialect),
        "{{real_const}}": "const {{real}}" if law.prediction is None else "{{real}}",
        "composite": str(law.prediction is not None),
        "if cumulative": f"if {leg.cumulative}",
    }
    composite = "" if law.prediction is None else ", and -P W'R (W beta - torque) of filtered motion"
    return LawInC(
        leg.joint_names,
        "tau = Y(q, v, v_r, a_r) beta - Kd s, beta' = -P gamma Y's" + composite,
        _filled("adaptive", values),
        law.rate,
        np.asarray(law.kd).copy(),
        MOTION,
        (*_tables(law), *_tables_of_cone(law), *_tables_of_prediction(law, law.prediction)),
        tuple(_memory(law, law.prediction is not None)),
        _filled("adaptive_begin", values),
        _filled("adaptive_helpers", values),
        leg=leg_in_c(linear.model, (), None, dialect),
    )


def _filled(name: str, values: dict[str, str]) -> str:
    """Template of a step with the sizes of this law."""
    text = step_of(name)
    for key, value in values.items():
        text = text.replace(key, value)
    return text


def _columns(law: Adaptive, dialect: Dialect) -> str:
    """Statements that fill the columns of springs, friction and rotors."""
    lines = []
    for k, (symbol, joint) in enumerate(law.model.kinds, start=len(law.model.model.leg.parameter_names)):
        if symbol == "c0":
            column = f"tanh(v_r[{joint}] / {dialect.number(WIDTH)})"
        elif symbol in ("d", "Ia"):
            column = f"{'v_r' if symbol == 'd' else 'a_r'}[{joint}]"
        else:
            column = " * ".join([f"q[{joint}]"] * int(symbol[1:])) or dialect.number(1.0)
        lines.append(f"    Y[{joint}][{k}] = {column}; /* {law.names[k]} */")
    return "\n".join(lines)


def _tables(law: Adaptive) -> tuple[ArrayInC, ...]:
    """Gains, and the geometry of the leg."""
    chain, n = law.model.model.leg.chain, law.model.n
    assert chain is not None
    offsets = np.vstack([chain.offsets[:, :2], np.zeros((n - len(chain.offsets), 2))])
    return (
        ArrayInC("axis", "+1 where positive q turns x towards z", np.array(chain.signs, dtype=np.float64)),
        ArrayInC("reach_x", "to the next joint, along x at the zero pose [m]", offsets[:, 0]),
        ArrayInC("reach_z", "to the next joint, along z at the zero pose [m]", offsets[:, 1]),
        ArrayInC("weight", "gravity [m/s^2]", np.array(GRAVITY)),
        ArrayInC("kd", "Kd [N m s/rad]", np.asarray(law.kd).copy()),
        ArrayInC("slope", "Kp / Kd [1/s]", law.kp / law.kd),
        ArrayInC("dead_zone", "half width of the dead zone of s [rad/s]", np.asarray(law.dead_zone).copy()),
        ArrayInC("still", "velocity below which a joint stands [rad/s]", np.asarray(law.still).copy()),
        ArrayInC("same", "difference of torques below which none was limited [N m]", np.array(LIMITED)),
        ArrayInC("learning", "gamma T", np.array(law.gain / law.rate)),
    )


def _tables_of_cone(law: Adaptive) -> tuple[ArrayInC, ...]:
    """Point masses, and those of the parameters at the beginning."""
    generators, start, metric, P = law.cone.generators, law.start, law.metric, len(law.names)
    columns = metric @ generators
    length = np.linalg.norm(columns, axis=0)
    masses = law.cone.masses(start, metric)
    found = np.flatnonzero(masses)[:P]
    chosen, weight = np.zeros((2, P))
    chosen[: len(found)], weight[: len(found)] = found, masses[found]
    return (
        ArrayInC("start", "initial parameters, SI", start.copy()),
        ArrayInC("floor", "point from which the set of parameters begins", law.cone.floor.copy()),
        ArrayInC("generator", "parameters of point masses and unit coefficients", generators.T.copy()),
        ArrayInC("generator_scale", "1 over their size in the initial metric", 1.0 / length),
        ArrayInC(
            "inside", "distance in standard deviations at which a point counts as one of the set", np.array(INSIDE)
        ),
        ArrayInC("start_chosen", "point masses of the initial parameters", chosen),
        ArrayInC("start_weight", "their weights", weight),
        ArrayInC("start_count", "their number", np.array(float(len(found)))),
    )


def _tables_of_prediction(law: Adaptive, prediction: TorquePrediction | None) -> tuple[ArrayInC, ...]:
    """Metric that is constant, or filters and weights of composite adaptation."""
    if prediction is None:
        return (
            ArrayInC("covariance", "covariance P of the parameters", law.model.covariance.copy()),
            ArrayInC("metric", "L with L'L the inverse of the covariance", law.metric),
        )
    constants = {
        "settled": (SETTLED * prediction.filter(law.rate).delay, "time until the filters have settled [s]"),
        "sliding": (SLIDING, "velocity above which friction is known [rad/s]"),
        "evidence": (1.0 / law.rate / (prediction.torque_std**2 * prediction.correlation), "T R [1/(N m)^2]"),
        "kept": (float(np.exp(-1.0 / law.rate / prediction.memory)), "information that one step keeps"),
        "period": (1.0 / law.rate, "period [s]"),
    }
    return (
        ArrayInC("initial", "information at the beginning, inverse of the covariance", law.initial_information),
        *(ArrayInC(name, what, np.array(value)) for name, (value, what) in constants.items()),
        *filter_tables(prediction.filter(law.rate)),
    )


def _memory(law: Adaptive, composite: bool) -> list[ArrayInC]:
    """Memory before the first sample, which the beginning fills."""
    n, nothing = law.model.n, np.zeros(len(law.names))
    found = [
        ArrayInC("beta", f"parameters: {', '.join(law.names)}", nothing),
        ArrayInC("chosen", "point masses that they consist of", nothing),
        ArrayInC("weight", "weights of these", nothing),
        ArrayInC("chosen_count", "number of these", np.array(0.0)),
        ArrayInC("requested", "torque requested at the previous sample [N m]", np.zeros(n)),
        ArrayInC("skipped", "samples that taught nothing: projection too long, or numbers too large", np.array(0.0)),
    ]
    if not composite:
        return found
    information: FloatArray = np.zeros((len(law.names), len(law.names)))
    found += [ArrayInC(name, what, np.zeros(n)) for name, what in MOTION_MEMORY.items()]
    return [
        *found,
        ArrayInC("information", "information, inverse of the gain", information),
        ArrayInC("age", "time since the first sample [s]", np.array(0.0)),
    ]
