"""Stand, sit down on a chair, and rise from it."""

from __future__ import annotations

import numpy as np

from exoid.errors import BadArgumentError
from exoid.experiments.references import minimum_jerk

from .body import SEAT, SIDES, Body
from .function import PHASE, Function, placed

STANDING = 0.97
"""Height of the hip while standing over the length of the straight leg."""


def stand(body: Body) -> Function:
    """Stand on both feet.

    Args:
        body: The wearer.

    Returns:
        The function, of one second.
    """
    hip = np.full(len(PHASE), STANDING * 1j * body.leg)
    return placed("stand", body, 1.0, hip, np.zeros(len(PHASE)), ((0.0, frozenset(SIDES)),))


def sit(body: Body, *, seat: float = 0.45, duration: float = 2.5) -> Function:
    """Sit down on a chair behind the feet.

    Args:
        body: The wearer.
        seat: Height of the seat [m].
        duration: Duration [s].

    Returns:
        The function; the seat bears load from 0.85 of it.

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    standing, seated = STANDING * 1j * body.leg, seated_hip(body, seat)
    s = minimum_jerk(PHASE / 0.9)  # and rests
    hip = np.asarray(standing + s * (seated - standing), dtype=np.complex128)
    pitch = -0.5 * np.sin(np.pi * s) ** 2  # [rad]: the torso leans forward half-way
    order = ((0.0, frozenset(SIDES)), (0.85, frozenset((*SIDES, SEAT))))
    return placed("sit", body, duration, hip, pitch, order)


def seated_hip(body: Body, seat: float) -> complex:
    """Locate the hip of a seated wearer, whose shanks lean back by 0.1 rad, from the middle of the soles.

    Args:
        body: The wearer.
        seat: Height of the seat [m].

    Returns:
        Place of the hip [m].

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    up = seat + body.seat
    knee = -0.5 * (body.heel + body.toe) + 1j * body.ankle + body.shank * np.exp(1j * (0.5 * np.pi - 0.1))
    drop = up - knee.imag
    if not abs(drop) < 0.9 * body.thigh:
        raise BadArgumentError(f"a seat of {seat:g} m for a leg of {body.leg:.3g} m", remedy="0.4 to 0.5 m are usual")
    return complex(knee.real - np.sqrt(body.thigh**2 - drop**2), up)


def rise(body: Body, *, seat: float = 0.45, duration: float = 2.5) -> Function:
    """Stand up from a chair: sitting down in reverse.

    Args:
        body: The wearer.
        seat: Height of the seat [m].
        duration: Duration [s].

    Returns:
        The function; seat-off is planned at 0.15 of it.

    Raises:
        ExoidError: The seat is too high or too low for the legs.
    """
    down = sit(body, seat=seat, duration=duration)
    order = ((0.0, frozenset((*SIDES, SEAT))), (0.15, frozenset(SIDES)))
    return Function("rise", duration, down.flexion[::-1], down.torso[::-1], order)
