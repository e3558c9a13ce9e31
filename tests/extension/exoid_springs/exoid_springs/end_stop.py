"""A rubber end stop: a spring that begins at an angle and grows stiffer."""

from dataclasses import dataclass

import numpy as np

from exoid.codegen import register_c_form
from exoid.torques import Term


@dataclass(frozen=True, kw_only=True)
class EndStop(Term):
    """τ = k sgn(q) (|q| − onset)^power beyond the onset, and 0 before it.

    Attributes:
        onset: Angle at which the stop begins [rad].
        power: Exponent.
        sides: Directions in which there is a stop, "lower" and "upper".
    """

    onset: float = 0.3
    power: int = 2
    sides: tuple[str, ...] = ("lower", "upper")

    @property
    def symbols(self):
        return ("k",)

    @property
    def units(self):
        return (f"N·m/rad^{self.power}",)

    @property
    def nonnegative(self):
        return ("k",)

    def fill(self, motion, out):
        q = motion.q
        present = np.where(q > 0.0, "upper" in self.sides, "lower" in self.sides)
        out[0] = present * np.sign(q) * np.maximum(np.abs(q) - self.onset, 0.0) ** self.power


@register_c_form(EndStop, "stiffness")
def end_stop_in_c(term, joint):
    q, zero = joint.variable, joint.number(0.0)
    beyond = f"({joint.function('fabs')}({q}) - {joint.number(term.onset)})"
    torque = f"{joint.parameter('k')} * {joint.function('pow')}({beyond}, {joint.number(term.power)})"
    upper = torque if "upper" in term.sides else zero
    lower = f"-{torque}" if "lower" in term.sides else zero
    return f"({beyond} > {zero} ? ({q} > {zero} ? {upper} : {lower}) : {zero})"
