"""A control law as data for C: its inputs, constants, memory and equation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.leg.leg import Leg

from .dialect import Dialect

Needed = Literal["gravity", "springs", "friction", "inverse_dynamics", "rigid_bodies", "mass_matrix", "bodies"]
"""Functions of the leg that a law may call; "bodies" are its pose, its recursion and the table of its rotors."""


class InputInC(NamedTuple):
    """Input of a law beside the measured angles q and velocities v.

    Attributes:
        name: Name in C.
        what: Comment with the unit.
        source: Whether it is measured or belongs to the reference; the watchdog looks after both.
        size: Number of values; None for one at each joint.
    """

    name: str
    what: str
    source: Literal["reading", "target"] = "target"
    size: int | None = None


REFERENCE = (
    InputInC("q_d", "desired angles [rad]"),
    InputInC("v_d", "desired velocities [rad/s]"),
)
"""Reference of laws that need no acceleration."""

MOTION = (*REFERENCE, InputInC("a_d", "desired accelerations [rad/s^2]"))
"""Reference of laws that need acceleration."""


class ArrayInC(NamedTuple):
    """Array of a law: a table of constants, or part of its memory.

    Attributes:
        name: Name in C; a table gets the prefix of the file.
        what: Comment with the unit.
        values: Constants, real or whole; for memory the values at the beginning. The shape is that in C.
    """

    name: str
    what: str
    values: NDArray[Any]


class PartInC(NamedTuple):
    """Part of a law: tables, memory, and template of its functions."""

    tables: tuple[ArrayInC, ...]
    memory: tuple[ArrayInC, ...]
    helpers: str


class LegInC(NamedTuple):
    """Model of a leg inside a law."""

    leg: Leg  # rigid bodies with their parameters
    springs: tuple[str, ...]  # torque of springs and offsets at each joint, as an expression in q[j], n of them
    friction: tuple[str, ...]  # torque of friction at each joint, as an expression in v[j], n of them
    rotor: tuple[str, ...]  # inertia that is not part of the bodies at each joint, as a constant expression, n of them
    needed: tuple[Needed, ...]  # functions that the law calls


@dataclass(frozen=True, eq=False)
class LawInC:
    """A law for C.

    ``step`` is a template in Jinja: C statements that compute ``tau[j]`` of all joints from ``in->q``, ``in->v``, the
    other inputs, the tables ``{{p}}_<name>`` and the memory ``state-><name>``, which they update. ``int j`` exists.
    Available names are ``p`` (prefix), ``N`` (number of joints), ``real`` (type), ``number(x)``, ``function("sin")``
    and ``rate`` [Hz]. The functions of the leg are ``{{p}}_gravity(q, tau)``, ``{{p}}_springs(q, tau)``,
    ``{{p}}_friction(v, tau)``, ``{{p}}_inverse_dynamics(q, v, a, tau)`` (all but friction),
    ``{{p}}_rigid_bodies(q, v, a, tau)`` and ``{{p}}_mass_matrix(q, M)``. ``bodies`` are the
    pose ``{{p}}_at(q, &pose)``, the torque ``{{p}}_newton_euler(&pose, v, a, weight, tau)`` under ``weight`` times
    gravity, and the table ``{{p}}_rotor``.

    Attributes:
        joints: Names of the joints, n of them.
        equation: Equation for the comment at the top.
        step: Template of the statements.
        rate: Sampling rate [Hz].
        damping: Damping of the safe torque unless another is chosen [N·m·s/rad], (n,).
        inputs: Inputs beside q and v.
        tables: Constants.
        memory: Memory between samples.
        begin: Template of statements that fill the memory at the first sample; empty if initial values suffice.
        helpers: Template of functions that the steps call.
        gives: What ``tau`` is.
        leg: Model of the leg; None if the law needs none.
        limit: Largest torque [N·m], (n,); inf for none.
        slew: Largest rate of change of the torque [N·m/s], (n,); inf for none.
        settling: Number of steps after which filters have settled, with a status and a check of angles; 0 for none.
        farthest: Largest change of an angle in one step of such a law [rad].
        solver: Whether the step calls a solver of quadratic programs, ``in->solve``.
    """

    joints: tuple[str, ...]
    equation: str
    step: str
    rate: float
    damping: FloatArray
    inputs: tuple[InputInC, ...] = ()
    tables: tuple[ArrayInC, ...] = ()
    memory: tuple[ArrayInC, ...] = ()
    begin: str = ""
    helpers: str = ""
    gives: str = "torque to hold until the next step"
    leg: LegInC | None = None
    limit: FloatArray | float = np.inf
    slew: FloatArray | float = np.inf
    settling: int = 0
    farthest: float = np.inf
    solver: bool = False


def law_in_c(law: object, dialect: Dialect) -> LawInC:
    """Describe a law by its method ``in_c``, unless a subclass computes something else than that method says."""
    # The method must stand in the class that computes the torque, or in one derived from it.
    kinds = type(law).__mro__
    described = next((kind for kind in kinds if "in_c" in vars(kind)), None)
    computed = next((kind for kind in kinds if vars(kind).keys() & {"torque", "step"}), None)
    if described is None or (computed is not None and not issubclass(described, computed)):
        raise NotSupportedError(
            f"{type(law).__name__} has no form in C",
            remedy="give it a method in_c(self, dialect) that returns an exoid.codegen.LawInC",
        )
    description: LawInC = law.in_c(dialect)  # type: ignore[attr-defined]
    return description
