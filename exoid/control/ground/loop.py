"""A law on the ground as the controller of the rig: contacts by switches, shares that move, a reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.rig.ground import GroundMotion, GroundReading

from .law import ContactKind, GroundState, GroundTarget, StanceCommand, StanceLaw, share_course

LOADING = 0.15
"""Time in which a foot that touches down takes its share [s], an assumption."""

BOUNCE = 0.02
"""Time for which an open switch still counts as closed [s]: a foot bounces as it touches down."""

LEVEL = 0.05
"""Tilt up to which a sole that touches with one end is taken for flat, which presses the other end down [rad]."""

BRAKE = 5.0
"""Damping of the joints while nothing touches the ground [N·m·s/rad], an assumption."""


@dataclass(eq=False)
class GroundLoop:
    """Controller of :func:`exoid.rig.ground.simulate_on_ground` made of a law, with a memory: one for each run.

    Contacts are those of the switches, but a foot whose planned share is zero is in the air, and a level one is flat.
    A foot that touches down takes its share in :data:`LOADING`. While nothing touches, the joints are braked.

    Attributes:
        law: The law.
        motion: Reference of joints and torso.
        shares: Planned shares at a time, by the link of the sole; one that is not named has the
            share 1. None for equal shares.
        lean: Angle by which the ground rises forward [rad], for contacts that are not flat.
        commands: What the law wanted at each sample, None where nothing touched.
        state: State at the last sample.
    """

    law: StanceLaw
    motion: GroundMotion
    shares: Callable[[float], Mapping[str, float]] | None = None
    lean: float = 0.0
    commands: list[StanceCommand | None] = field(default_factory=list)
    state: GroundState | None = None

    def __post_init__(self) -> None:
        """Interpolate the reference."""
        reference = np.column_stack([self.motion.q, self.motion.base[:, 2]])
        self._reference = scipy.interpolate.CubicSpline(self.motion.time, reference)
        self._closed: dict[str, float] = {}  # when a switch of each sole was closed last [s]
        self._since: dict[str, float] = {}  # when each contact began [s]

    def target(self, time: float) -> GroundTarget:
        """Return the reference at a time.

        Args:
            time: Time [s].

        Returns:
            Joints and pitch with their derivatives.
        """
        x, v, a = (self._reference(time, k) for k in range(3))
        return GroundTarget(x[:-1], v[:-1], a[:-1], x[-1], v[-1], a[-1])

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque to hold until the next sample.

        Args:
            reading: Readings of the rig.

        Returns:
            Torque [N·m], (n,).
        """
        planned = {} if self.shares is None else self.shares(reading.time)
        self._closed |= {link: reading.time for link, closed in reading.switches.items() if closed.any()}
        touching = [link for link, last in self._closed.items() if reading.time - last < BOUNCE]
        contacts = {link: self._kind(link, reading) for link in touching if planned.get(link, 1.0) > 0.0}
        self._since = {link: self._since.get(link, reading.time) for link in contacts}
        ramps = {link: float(share_course((reading.time - self._since[link]) / LOADING)) for link in contacts}
        if not any(ramps.values()):
            ramps = dict.fromkeys(contacts, 1.0)  # the first foot on the ground bears all at once
        shares = {link: planned.get(link, 1.0) * ramp for link, ramp in ramps.items()}
        push = reading.push
        state = GroundState(
            reading.q,
            reading.v,
            reading.pitch,
            reading.pitch_rate,
            contacts,
            shares,
            reading.time,
            None,
            push,
            self.lean,
        )
        self.state = state
        command = self.law.command(state, self.target(reading.time)) if contacts else None
        self.commands.append(command)
        return -BRAKE * reading.v if command is None else command.torque

    def _kind(self, link: str, reading: GroundReading) -> ContactKind:
        """Part of a sole that touches: all of it if it is parallel to the ground, whichever switch is closed."""
        closed = reading.switches[link]
        heel, toe = closed[: len(closed) // 2].any(), closed[len(closed) // 2 :].any()
        tilt = reading.pitch + self.law.model.turns[link] @ reading.q - self.lean
        return "flat" if abs(tilt) < LEVEL or (heel and toe) else "heel" if heel else "toe"
