"""Tracking error, torque and energy of a controller."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Run
from exoid.signals import Recording
from exoid.tools.json_values import attributes
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, to_text
from exoid.torques.position_units import PositionUnit, heading, position_units


@dataclass(frozen=True, eq=False, repr=False)
class Tracking(ReadOnly):
    """Run of one leg under one controller; prints itself as a table.

    Metrics refer to the true motion and torque from ``settle`` on, (n,) each.

    Attributes:
        law: Name of the controller.
        rate: Sampling rate of the controller [Hz].
        joint_names: Names of the joints, (n,).
        time: Time [s], (N,).
        target: Reference angles [rad], (N, n).
        q: True angles [rad], (N, n).
        v: True velocities [rad/s], (N, n).
        tau: True torques, each the one held until that moment [N·m], (N, n).
        recording: Log of the sensors.
        settle: Time at the beginning that the metrics leave out [s].
        interaction: True torque of the wearer on the leg [N·m], (N, n); None without wearer.
        units: Unit in which errors of each joint are shown, (n,).
    """

    law: str
    rate: float
    joint_names: tuple[str, ...]
    time: FloatArray
    target: FloatArray
    q: FloatArray
    v: FloatArray
    tau: FloatArray
    recording: Recording
    settle: float = 0.0
    interaction: FloatArray | None = None
    units: tuple[PositionUnit, ...] = field(kw_only=True)

    @property
    def error(self) -> FloatArray:
        """Reference minus true angle [rad], (N, n)."""
        return self.target - self.q

    @property
    def peak_deg(self) -> FloatArray:
        """Largest tracking error [deg], of a slide [mm]."""
        return np.asarray(np.abs(self._settled(self.error)).max(axis=0) / [unit.size for unit in self.units])

    @property
    def rms_deg(self) -> FloatArray:
        """RMS tracking error [deg], of a slide [mm]."""
        return np.asarray(rms(self._settled(self.error)) / [unit.size for unit in self.units])

    @property
    def rms_torque(self) -> FloatArray:
        """RMS torque [N·m]; a motor's heat is proportional to its square."""
        return rms(self._settled(self.tau))

    @property
    def energy(self) -> FloatArray:
        """Energy ∫ |τ θ̇| dt of actuators without recuperation [J]."""
        power = np.abs(self._settled(self.tau) * self._settled(self.v))
        return np.asarray(np.trapezoid(power, self._settled(self.time), axis=0))

    @property
    def torque_variation(self) -> FloatArray:
        """Total variation Σ |Δτ| per second, a measure of chatter [N·m/s]."""
        time = self._settled(self.time)
        return np.asarray(np.abs(np.diff(self._settled(self.tau), axis=0)).sum(axis=0) / (time[-1] - time[0]))

    @property
    def rms_interaction(self) -> FloatArray:
        """RMS torque of the wearer on the leg [N·m]: what the wearer feels.

        Raises:
            ExoidError: Nobody wears the leg.
        """
        if self.interaction is None:
            raise BadArgumentError("nobody wears this leg", remedy="simulate it with wearer=")
        return rms(self._settled(self.interaction))

    def to_json(self) -> dict[str, Any]:
        """Convert the metrics to JSON types.

        Returns:
            Values of the joints by the name of the metric; ``rms_interaction`` too if the leg was worn.
        """
        felt = () if self.interaction is None else ("rms_interaction",)
        return attributes(self, "peak_deg", "rms_deg", "rms_torque", "torque_variation", *felt)

    def _settled(self, values: FloatArray) -> FloatArray:
        first = int(np.searchsorted(self.time, self.settle - 1e-9))
        return values[max(1, first) :]  # no torque was held before the first sample

    def __repr__(self) -> str:
        """Name the controller and its errors."""
        each = zip(self.joint_names, self.peak_deg, self.units, strict=True)
        peaks = ", ".join(f"{name} {error:.3g}{unit.name}" for name, error, unit in each)
        return f"Tracking({self.law} at {self.rate:g} Hz: peak {peaks})"

    def __str__(self) -> str:
        """Print as a table, one line for each joint."""
        return to_text(tracking_table(f"from {self.settle:g} to {self.time[-1]:g} s", (self,)))


def tracking_table(caption: str, trackings: Iterable[Tracking]) -> DataTable:
    """Make a table of several controllers, with the torque of the wearer if they are worn."""
    runs = tuple(trackings)
    position, torque, rate = (heading(runs[0].units, of) if runs else "" for of in ("{deg}", "{torque}", "{torque}/s"))
    figures = {
        f"peak [{position}]": ("peak_deg", 2),
        f"rms [{position}]": ("rms_deg", 2),
        f"rms [{torque}]": ("rms_torque", 1),
        "energy [J]": ("energy", 1),
        f"TV [{rate}]": ("torque_variation", 1),
    }
    if runs and all(one.interaction is not None for one in runs):
        figures[f"wearer [{torque}]"] = "rms_interaction", 2
    rows = []
    for one in runs:
        columns = [[f"{x:.{digits}f}" for x in getattr(one, name)] for name, digits in figures.values()]
        joints = [name.removeprefix("left_").removeprefix("right_") for name in one.joint_names]
        first = [(one.law, f"{one.rate:g}"), *[("", "")] * (len(joints) - 1)]
        rows += [(*labels, *texts) for labels, *texts in zip(first, joints, *columns, strict=True)]
    return DataTable(caption, ("controller", "[Hz]", "joint", *figures), rows)


def tracking_of(run: Run, rig: int, law: str, rate: float, settle: float) -> Tracking:
    """Take one rig out of a run."""
    target, q, v, tau = (x[..., rig] for x in (run.target, run.q, run.v, run.tau))
    log, felt = run.recording(rig, velocity=True), None if run.interaction is None else run.interaction[..., rig]
    leg, motion = run.plant.leg, (run.time, target, q, v, tau, log)
    return Tracking(law, rate, leg.joint_names, *motion, settle, felt, units=position_units(leg))


def rms(values: FloatArray) -> FloatArray:
    """RMS over the samples."""
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))
