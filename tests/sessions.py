"""Sessions of legs of one design whose joints differ in friction, and whose torque sensors differ in their zero."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from swings import SMOOTH, SMOOTHING, Swing, coloured, log_of

from exoid import Leg
from exoid.torques import Offset, TorqueModel, Viscous

TERMS = (SMOOTH, Viscous(), Offset())
"""What acts on the joints."""


class Noise(NamedTuple):
    """Torque noise e_t = φ e_{t−1} + ε_t.

    Attributes:
        std: Of e [N·m], one for each joint or one for all.
        memory: φ.
    """

    std: float | tuple[float, ...] = 0.0
    memory: float = 0.0

    def draw(self, rng, shape):
        return self.std * coloured(rng, shape, self.memory)


SILENCE = Noise()


@dataclass(frozen=True)
class Session:
    """One session with one leg.

    Attributes:
        leg: The leg.
        seed: Of the motion.
        offset: Of the torque sensors [N·m], (n,).
        coulomb: Friction [N·m], (n,).
        viscous: Friction [N·m·s/rad], (n,).
        seconds: Duration.
        rate: Of the samples [Hz].
    """

    leg: Leg
    seed: int = 1
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    coulomb: tuple[float, ...] = (0.8, 0.6, 0.4)
    viscous: tuple[float, ...] = (0.5, 0.3, 0.2)
    seconds: float = 12.0
    rate: float = 100.0

    @property
    def truth(self):
        """Values by name of the parameters that the session has."""
        model = TorqueModel(self.leg, TERMS)
        return dict(zip(model.names, [*self.leg.parameters, *self.coulomb, *self.viscous, *self.offset], strict=True))

    def recording(self, rng=None, noise=SILENCE):
        """Exact motion, torque with noise if any."""
        swing = Swing(self.leg, self.rate, self.seconds, self.seed, base=0.15)
        q, v, a = swing.motion
        acting = self.offset + np.multiply(self.coulomb, np.tanh(v / SMOOTHING)) + np.multiply(self.viscous, v)
        if rng is not None:
            acting = acting + noise.draw(rng, acting.shape)
        return log_of(self.leg, swing.time, (q, v, a), acting, exact=True)


def truth_of(together, sessions):
    """True values of all parameters of several sessions, in the order of ``together.names``."""
    first = next(iter(sessions.values())).truth
    own = {f"{name}[{group}]": value for group, session in sessions.items() for name, value in session.truth.items()}
    return np.array([first.get(name, own.get(name)) for name in together.names], dtype=float)
