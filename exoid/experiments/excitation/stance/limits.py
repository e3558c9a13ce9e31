"""Limits of a motion on the ground: what keeps the feet flat, and the swinging foot in the air."""

from __future__ import annotations

from dataclasses import dataclass, fields

from exoid.errors import ExoidError


@dataclass(frozen=True)
class GroundLimits:
    """Limits of ground force, torso, knees and feet.

    Attributes:
        friction: Coefficient of friction that a motion may use, below that of the ground.
        sole_margin: Distance of the centre of pressure from heel and toe [m].
        least_load: Smallest vertical force over the weight of the machine.
        most_load: Largest vertical force over the weight.
        doubt: Relative standard deviation of each expected parameter of the rigid bodies. Limits of force and torque
            are kept at twice the standard deviation that it causes.
        bow_deg: Largest pitch of the torso forward [deg].
        recline_deg: Largest pitch of the torso backward [deg].
        knee_deg: Smallest flexion of a knee [deg]: at a straight knee a foot leaves no row of the equation.
        clearance: Smallest height of a foot that does not stand [m].

    Raises:
        ExoidError: A number is negative, not finite, or contradicts another.
    """

    friction: float = 0.4
    sole_margin: float = 0.02
    least_load: float = 0.5
    most_load: float = 1.5
    doubt: float = 0.05
    bow_deg: float = 40.0
    recline_deg: float = 10.0
    knee_deg: float = 15.0
    clearance: float = 0.03

    def __post_init__(self) -> None:
        """Check the numbers."""
        for field in fields(self):
            if not 0.0 <= getattr(self, field.name) < float("inf"):
                raise ExoidError(f"{field.name} is {getattr(self, field.name)}", remedy="give a finite number ≥ 0")
        if not (self.friction > 0.0 and self.least_load < 1.0 < self.most_load and self.doubt < 0.5):
            raise ExoidError(
                f"friction {self.friction:g}, load from {self.least_load:g} to {self.most_load:g} of the weight, "
                f"doubt {self.doubt:g}",
                remedy="friction is above 0, the load at rest is 1, and a doubt is less than 0.5",
            )
