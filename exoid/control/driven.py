"""Commands of drives around any controller: currents, forces or motor angles in place of torques."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.rig import Target

from .law import State, torque_without_memory
from .limited import Wrapped


@dataclass(frozen=True, eq=False)
class Driven(Wrapped):
    """Another controller whose torques drives make, within their limits.

    :meth:`command` is for the real machine: current [A] = τ / (ratio · η^±1 · k_t), force [N] = τ / r(q), motor angle
    [rad] = ratio (q + τ / k). :meth:`torque` is what the drives then make of it: the torque of the other controller
    where no drive is at its limit. It is the torque on the virtual rig.

    Attributes:
        law: The other controller, with or without memory.
        actuators: Drives of its leg.

    Example:
        >>> import numpy as np
        >>> from exoid.actuators import Motor
        >>> from exoid.control import pd
        >>> leg = exoid.load_leg("cuhk")
        >>> motors = Actuators.of(leg, {"hip": Motor(0.07, 50.0), "knee": Motor(0.07, 50.0)})
        >>> law = Driven(pd(350.0, 0.0), motors)
        >>> state, target = State(np.zeros(2), np.zeros(2)), Target(np.array([0.1, 0.02]), np.zeros(2))
        >>> print(*law.command(state, target).round(6))
        10.0 2.0
    """

    actuators: Actuators

    def command(self, state: State, target: Target) -> FloatArray:
        """Compute the commands to hold until the next sample.

        Args:
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Commands in ``actuators.units``, of the shape of ``state.q``.

        Raises:
            ExoidError: A drive cannot make a torque, such as a cylinder at its dead centre; or the other controller
                has memory: then ``actuators.command`` turns the torque of its step into commands.
        """
        return self._command_of(torque_without_memory(self.law, state, target), state)

    def _changed(self, torque: FloatArray, state: State) -> FloatArray:
        """Compute the torque that the drives make of the commands for a torque."""
        command = self._command_of(torque, state)
        return self.actuators.torque_of(command.T, state.q.T, state.v.T).T.reshape(command.shape)

    def _command_of(self, torque: FloatArray, state: State) -> FloatArray:
        return self.actuators.command(torque.T, state.q.T, state.v.T).T.reshape(torque.shape)
