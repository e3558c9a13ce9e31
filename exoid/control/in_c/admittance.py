"""Admittance control with its virtual mass in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, ArrayInC, InputInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.codegen.laws.write import ABSURD
from exoid.control.admittance import Admittance

from .forms import register_law_in_c
from .leg import damping_of, leg_in_c
from .passive_friction import friction_of, passive, passive_in_words
from .steps import step_of

INTERACTION = InputInC("interaction", "torque of the wearer on the leg, by sensors or an observer [N m]", "reading")


@register_law_in_c(Admittance)
def admittance_in_c(law: Admittance, dialect: Dialect) -> LawInC:
    """Describe admittance control; it measures the torque of the wearer.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or numbers are not those of one leg.
    """
    n, half = law.model.n, 0.5 / law.rate
    mass, damping, stiffness, frequency, reach = (
        per_joint(getattr(law, name), name, n) for name in ("mass", "damping", "stiffness", "frequency", "reach")
    )
    tables = {
        "virtual_mass": (mass + half * (damping + half * stiffness), "m + (D + K T/2) T/2 [kg m^2]"),
        "virtual_damping": (damping, "D [N m s/rad]"),
        "virtual_stiffness": (stiffness, "K [N m/rad]"),
        "frequency": (frequency, "natural frequency omega of following [rad/s]"),
        "reach": (np.minimum(reach, ABSURD), f"largest deviation from the target [rad]; {ABSURD:g} for none"),
        "half": (np.array(half), "half a period [s]"),
    }
    memory = {"x": "position of the virtual mass [rad]", "rate": "its velocity [rad/s]"}
    return LawInC(
        law.model.leg.joint_names,
        "m x'' + D x' + K x = interaction; tau = M(q) (a_d + x'' + 2 omega (v_d + x' - v) + omega^2 (q_d + x - q)) "
        f"+ C(q, v) v + G(q) + springs(q){passive_in_words(law.friction, 'v')} - interaction",
        step_of("admittance").replace("{{friction}}", passive(law.friction, "in->v")),
        law.rate,
        damping_of(law.model),
        (*MOTION, INTERACTION),
        tuple(ArrayInC(name, what, values) for name, (values, what) in tables.items()),
        tuple(ArrayInC(name, what, np.zeros(n)) for name, what in memory.items()),
        leg=leg_in_c(law.model, ("inverse_dynamics",), friction_of(law.friction), dialect),
    )
