"""Run of a rig: true motion and torque, readings of the sensors, and energy balance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.leg.torso import TorsoMotion
from exoid.signals import Recording
from exoid.signals.torque_delay import DRIVE_CHANNELS
from exoid.tools.tables import DataTable, to_text, value_range
from exoid.torques.position_units import heading, position_units

from .plant import Plant


class Energy(NamedTuple):
    """Energy balance of a run [J], (B,) each: work = gain + dissipated, up to the integration error.

    Attributes:
        work: Work of the actuators, and of the muscles of wearers.
        gain: Gain of mechanical energy, springs, rotors and limbs of wearers included.
        dissipated: Energy that friction, end stops and cuffs dissipate.
        turnover: ∫ |power| dt of actuators and muscles or of what dissipates, the larger of the two; the scale of
            errors.
    """

    work: FloatArray
    gain: FloatArray
    dissipated: FloatArray
    turnover: FloatArray

    @property
    def relative_error(self) -> FloatArray:
        """Residual of the balance over the turnover, (B,); zero where nothing moved."""
        error = np.abs(self.work - self.gain - self.dissipated)
        return np.asarray(error / np.where(self.turnover > 0.0, self.turnover, np.inf))

    def __repr__(self) -> str:
        """Write the range of each part over the rigs."""
        parts = zip(("work", "gain", "dissipated"), (self.work, self.gain, self.dissipated), strict=True)
        text = ", ".join(f"{name} {value_range(values)} J" for name, values in parts)
        return f"Energy({len(self.work)} rigs: {text}; relative error up to {self.relative_error.max():.1g})"


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """True motion and torque of B rigs, and the readings of their sensors; K log samples.

    Attributes:
        plant: Simulated plant.
        time: Time [s], (K,).
        q: True angles [rad], (K, n, B).
        v: True velocities [rad/s], (K, n, B).
        tau: True actuator torques at the sample [N·m], (K, n, B).
        q_measured: Angle readings [rad], (K, n, B).
        v_measured: Velocity readings [rad/s], (K, n, B).
        tau_measured: Torque readings [N·m], (K, n, B).
        target: Reference angles [rad], (K, n, B).
        energy: Energy balance.
        interaction: True torque of the wearers on the legs [N·m], (K, n, B); None without wearer.
        limb_q: True angles of the wearers' limbs [rad], (K, n, B); None without wearer.
    """

    plant: Plant
    time: FloatArray
    q: FloatArray
    v: FloatArray
    tau: FloatArray
    q_measured: FloatArray
    v_measured: FloatArray
    tau_measured: FloatArray
    target: FloatArray
    energy: Energy
    interaction: FloatArray | None = None
    limb_q: FloatArray | None = None

    def __repr__(self) -> str:
        """Name the plant and the size of the log."""
        return f"Run({self.plant.description}: {self._size})"

    def __str__(self) -> str:
        """Print as a table: range of motion, tracking error and torque over all rigs, one line a joint."""
        units = position_units(self.plant.leg)
        at, speed, torque = (heading(units, of) for of in ("{deg}", "{rad}/s", "{torque}"))
        shown, error = (x / np.array([[unit.size] for unit in units]) for x in (self.q, self.target - self.q))
        rows = [
            (
                name,
                value_range((shown[:, joint].min(), shown[:, joint].max())),
                f"{np.abs(self.v[:, joint]).max():.3g}",
                f"{np.abs(error[:, joint]).max():.3g}",
                f"{np.sqrt(np.mean(error[:, joint] ** 2)):.3g}",
                f"{np.abs(self.tau[:, joint]).max():.3g}",
            )
            for joint, name in enumerate(self.plant.leg.joint_names)
        ]
        columns = ("angle", at), ("max speed", speed), ("max error", at), ("rms error", at), ("max torque", torque)
        headers = ("joint", *(f"{name} [{unit}]" for name, unit in columns))
        table = DataTable(f"Run of {self.plant.description}: {self._size}", headers, rows)
        return to_text(table, f"energy balance: relative error up to {self.energy.relative_error.max():.1g}")

    @property
    def _size(self) -> str:
        rate = 1.0 / (self.time[1] - self.time[0]) if len(self.time) > 1 else 0.0
        return f"{len(self.time)} samples at {rate:.4g} Hz, {self.time[-1]:.4g} s"

    def recording(
        self,
        rig: int = 0,
        *,
        velocity: bool = False,
        joint_names: Sequence[str] | None = None,
        actuators: Actuators | None = None,
    ) -> Recording:
        """Return the readings of one rig as a log.

        Drives measure what makes the torque readings at the true angles and velocities: their noise is that of the
        torque sensor.

        Args:
            rig: Index of the rig.
            velocity: Whether the log contains the measured velocity.
            joint_names: Names of the joints; None for those of the plant's leg.
            actuators: Drives whose currents, forces or motor angles are logged in place of the torques of their joints;
                None for torques.

        Returns:
            Log of the rig with its torso tilt.

        Raises:
            ExoidError: There is no such rig, the run is too short for a recording, or a drive cannot make the torque.
        """
        if not -self.plant.count <= rig < self.plant.count:
            raise BadArgumentError(f"no rig {rig} among {self.plant.count}", remedy="count from 0")
        names = self.plant.leg.joint_names
        log = Recording(
            time=self.time,
            q=self.q_measured[..., rig],
            v=self.v_measured[..., rig] if velocity else None,
            tau=self.tau_measured[..., rig],
            joint_names=tuple(joint_names or names),
            torso=TorsoMotion(pitch=float(self.plant.pitch[rig])) if self.plant.pitch[rig] else None,
            largest_angle=np.inf,
        )
        if actuators is None:
            return log
        true = replace(log, q=self.q[..., rig], v=self.v[..., rig], joint_names=names)
        measured = actuators.readings(true)
        return replace(log, tau=measured.tau, **{name: getattr(measured, name) for name in DRIVE_CHANNELS})
