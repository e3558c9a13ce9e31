"""Payload: a weighed body that is strapped to a segment of a leg, for recordings and for the virtual rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid.errors import BadArgumentError

from .description import FARTHEST

HEAVIEST = 500.0
"""Largest mass of a payload [kg]; a larger number is in grams."""

FORM = "SEGMENT:MASS@X,Y,Z in kg and m, such as shank:3.0@0,0,-0.3"
"""Form of a payload in text."""


@dataclass(frozen=True)
class Payload:
    """Body of known mass that is fixed to a segment.

    Attributes:
        joint: Joint that carries the body, by name or label: the hip for the thigh, the knee for the shank. The name of
            the segment (link) does as well.
        mass: Mass [kg].
        position: Centre of mass in the frame of that joint [m]. At the zero pose of the built-in legs x points forward
            and z up.
        gyration: Radius of gyration about the centre of mass [m], 0 for a point mass.

    Raises:
        ExoidError: A number is not finite, mass or radius is negative, or a number is too large to be in kg or m.

    Example:
        >>> Payload("knee", 3.0, (0.0, 0.0, -0.3)).mass
        3.0
    """

    joint: str
    mass: float
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gyration: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        try:
            numbers = np.array([self.mass, self.gyration, *self.position], dtype=np.float64)
        except (TypeError, ValueError):
            numbers = np.full(5, np.nan)
        if numbers.shape != (5,) or not np.isfinite(numbers).all() or numbers[:2].min() < 0.0:
            raise BadArgumentError(f"invalid payload: {self!r}", remedy="give mass in kg ≥ 0, and x, y, z in m")
        if not isinstance(self.joint, str) or not self.joint:
            raise BadArgumentError(f"a payload on {self.joint!r}", remedy="name the joint that carries it")
        if numbers[0] > HEAVIEST or np.abs(numbers[1:]).max() > FARTHEST:
            raise BadArgumentError(
                f"invalid payload, too heavy or too far away: {self!r}",
                remedy="give mass in kg, not g, and x, y, z in m, not mm",
            )
        mass, gyration, x, y, z = numbers.tolist()
        for name, value in (("mass", mass), ("gyration", gyration), ("position", (x, y, z))):
            object.__setattr__(self, name, value)

    @classmethod
    def from_text(cls, text: str) -> Payload:
        """Read a payload from text, "SEGMENT:MASS@X,Y,Z" or "SEGMENT:MASS@X,Y,Z:GYRATION".

        Args:
            text: The text; SEGMENT is a joint or link, numbers are in kg and m.

        Returns:
            The payload.

        Raises:
            ExoidError: The text has another form, or numbers are not those of a payload.

        Example:
            >>> Payload.from_text("shank:3.0@0,0,-0.3").position
            (0.0, 0.0, -0.3)
        """
        body, _, place = text.rpartition("@")
        joint, _, mass = body.rpartition(":")
        where, _, gyration = place.partition(":")
        try:
            x, y, z = (float(number) for number in where.split(","))
            numbers = float(mass), (x, y, z), float(gyration or 0.0)
        except ValueError:
            raise BadArgumentError(f"{text!r} is no payload", remedy=f"write {FORM}") from None
        return cls(joint.strip(), *numbers)

    def __str__(self) -> str:
        """Write the text that :meth:`from_text` reads."""
        gyration = f":{self.gyration!r}" if self.gyration else ""
        return f"{self.joint}:{self.mass!r}@{','.join(map(repr, self.position))}{gyration}"


def as_payloads(given: object) -> tuple[Payload, ...]:
    """Check that something is payloads; one alone may stand for itself."""
    found = tuple(given) if isinstance(given, (tuple, list)) else (given,)
    wrong = [one for one in found if not isinstance(one, Payload)]
    if wrong:
        raise BadArgumentError(
            f"{wrong[0]!r} is no payload",
            remedy='pass payloads=(Payload("knee", mass=3.0, position=(0.0, 0.0, -0.3)),)',
        )
    return found
