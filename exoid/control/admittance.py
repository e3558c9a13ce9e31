"""Admittance control: the measured torque of the wearer moves a virtual mass, which the leg follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import MOTION, Dialect, InputInC, LawInC
from exoid.codegen.dialect import ABSURD
from exoid.codegen.law_in_c import per_joint
from exoid.codegen.templates import step_of
from exoid.errors import BadArgumentError
from exoid.rig import Target
from exoid.tools.numbers import checked

from .c_description import describe
from .friction import PASSIVE, PassiveFriction, wearer_friction
from .law import State, freeze_gains, gains, refuse_rate, spread
from .model import ControlModel, ModelSource


class VirtualMass(NamedTuple):
    """Memory: motion of the virtual mass about the target, (n,) or (n, B) each."""

    x: FloatArray  # deviation from the target [rad]
    rate: FloatArray  # rate of change of the deviation [rad/s]


@dataclass(frozen=True, eq=False)
class Admittance:
    """m ẍ + D ẋ + K x = τ_wearer, and the leg follows θ_r = θ_d + x; a :class:`exoid.control.StatefulLaw`."""

    # τ = ID(θ, θ̇, θ̈_r + 2 ω (θ̇_r − θ̇) + ω² (θ_r − θ)) + τ_f − τ_wearer: with an exact model the leg moves
    # as the virtual mass does, whatever its own inertia. The virtual mass is integrated by the trapezoidal
    # rule, which is stable for every mass, damping and stiffness. The loop through the wearer is not: a virtual
    # mass that is small compared with the leg, late readings and stiff cuffs make it oscillate.

    mass: FloatArray  # virtual mass m [kg·m²], a number or (n,)
    damping: FloatArray  # virtual damping D [N·m·s/rad], likewise
    stiffness: FloatArray  # virtual stiffness K about the target [N·m/rad], likewise; 0 to go where the wearer pushes
    model: ControlModel  # model of the leg
    frequency: FloatArray  # natural frequency ω [rad/s] with which the leg follows, likewise
    # largest deviation from the target [rad], likewise; inf for none. The virtual mass stops there, so that a
    # constant error of the sensor does not carry it away
    reach: FloatArray
    friction: PassiveFriction | None = PASSIVE  # friction compensation, which never drives; None for none
    rate: float = 500.0  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check the numbers."""
        refuse_rate(self.rate)
        freeze_gains(self, "damping", "stiffness")
        for name in ("mass", "frequency", "reach"):
            value = checked(getattr(self, name), name, above=0.0, infinite=name == "reach", ndim=2)
            object.__setattr__(self, name, value)

    def begin(self, state: State) -> VirtualMass:
        """Compute the memory before the first sample."""
        return VirtualMass(np.zeros_like(state.q), np.zeros_like(state.q))

    def step(self, memory: VirtualMass, state: State, target: Target) -> tuple[FloatArray, VirtualMass]:
        """Compute the torque; see the class."""
        q, v, pushed = state.q, state.v, state.interaction
        if pushed is None:
            raise BadArgumentError(
                "this controller needs the torque of the wearer, State(interaction=...)",
                remedy="measure it in the cuffs, estimate it by an observer, or simulate with wearer=",
            )
        after, acceleration = self._move(memory, pushed)
        aim = acceleration if target.a is None else acceleration + target.a
        frequency = spread(self.frequency, q)
        error, slope = target.q + memory.x - q, target.v + memory.rate - v
        wanted = aim + frequency * (2.0 * slope + frequency * error)
        torque = self.model.inverse_dynamics(q, v, wanted) + wearer_friction(self.friction, self.model, q, v)
        return torque - pushed, after

    def _move(self, memory: VirtualMass, pushed: FloatArray) -> tuple[VirtualMass, FloatArray]:
        """Virtual mass a period later, and its mean acceleration until then."""
        mass, damping, stiffness, reach = (
            spread(x, pushed) for x in (self.mass, self.damping, self.stiffness, self.reach)
        )
        half = 0.5 / self.rate
        resisted = damping * memory.rate + stiffness * (memory.x + half * memory.rate)
        acceleration = (pushed - resisted) / (mass + half * (damping + half * stiffness))
        rate = memory.rate + 2.0 * half * acceleration
        x = memory.x + half * (memory.rate + rate)
        stopped = np.abs(x) > reach
        return VirtualMass(np.clip(x, -reach, reach), np.where(stopped, 0.0, rate)), acceleration

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C; it measures the torque of the wearer."""
        n, half = self.model.n, 0.5 / self.rate
        felt = InputInC("interaction", "torque of the wearer on the leg, by sensors or an observer [N m]", "reading")
        mass, damping, stiffness, frequency, reach = (
            per_joint(getattr(self, name), name, n) for name in ("mass", "damping", "stiffness", "frequency", "reach")
        )
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation="m x'' + D x' + K x = interaction; tau = M(q) (a_d + x'' + 2 omega (v_d + x' - v) + "
            "omega^2 (q_d + x - q)) + C(q, v) v + G(q) + springs(q){friction} - interaction",
            step=step_of("admittance"),
            calls=("inverse_dynamics",),
            inputs=(*MOTION, felt),
            tables={
                "virtual_mass": (mass + half * (damping + half * stiffness), "m + (D + K T/2) T/2 [kg m^2]"),
                "virtual_damping": (damping, "D [N m s/rad]"),
                "virtual_stiffness": (stiffness, "K [N m/rad]"),
                "frequency": (frequency, "natural frequency omega of following [rad/s]"),
                "reach": (np.minimum(reach, ABSURD), f"largest deviation from the target [rad]; {ABSURD:g} for none"),
                "half": (half, "half a period [s]"),
            },
            memory={"x": "position of the virtual mass [rad]", "rate": "its velocity [rad/s]"},
        )


def admittance(
    source: ModelSource,
    mass: ArrayLike,
    damping: ArrayLike,
    stiffness: ArrayLike = 0.0,
    *,
    frequency: ArrayLike = 20.0,
    reach: ArrayLike = np.inf,
    friction: PassiveFriction | None = PASSIVE,
    rate: float = 500.0,
) -> Admittance:
    """Make an :class:`Admittance` controller.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        mass: Virtual mass [kg·m²], a number or one for each joint.
        damping: Virtual damping [N·m·s/rad].
        stiffness: Virtual stiffness about the target [N·m/rad].
        frequency: Natural frequency with which the leg follows the virtual mass [rad/s], critically damped.
        reach: Largest deviation from the target [rad].
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A number does not fit, or the source has no control model.

    Example:
        >>> law = admittance(est, mass=0.5, damping=2.0, reach=0.8)  # doctest: +SKIP
    """
    virtual = gains(mass, "mass"), gains(damping, "damping"), gains(stiffness, "stiffness")
    limits = gains(frequency, "frequency"), np.asarray(reach, dtype=np.float64)
    return Admittance(*virtual, ControlModel.of(source), *limits, friction, rate)
