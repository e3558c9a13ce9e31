"""Torque between wearer and exoskeleton at each joint, from motion and actuator torque."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.actuators import Actuators, Coupling, Drive
from exoid.errors import NotIdentifiableError
from exoid.estimate import EstimateData, TorqueFilter
from exoid.estimate.compared import to_predict
from exoid.estimate.finding import Finding, ordered
from exoid.estimate.validation_checks import effective_share, extrapolations, unmeasured_torques
from exoid.identification.findings.channels import channel_findings
from exoid.regression.intervals import half_width
from exoid.signals import Recording
from exoid.signals.csv_writer import write_csv
from exoid.tools.json_values import json_value
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, Report, make_table
from exoid.torques.position_units import PositionUnit, heading, position_units

from .action import LEVEL, Evidence, JointAction, constant_torques, explanations, judge, rough_estimate, too_few_samples
from .evaluation import evaluate
from .gait import GaitProfile, find_phase, profile


@dataclass(frozen=True, eq=False, repr=False)
class Interaction(ReadOnly, Report):
    """Torque of the wearer on the leg, τ_w = W β − τ, over a recording; prints itself as a table.

    Samples near the ends of a recording, in which filters have not settled, are left out.

    Attributes:
        joint_names: Joints, (n,).
        time: [s], (N,).
        torque: Torque of the wearer on the leg [N·m], (N, n), low-passed as torques of the estimate are; not a number
            where the actuator torque of a joint was not measured.
        band: Half the width of the 95 % band of the torque [N·m], (N, n): errors of parameters and of the form of
            friction, and noise of the measurement.
        velocity: Velocity of the joints [rad/s], (N, n).
        phase: Phase of the gait, 0 to 1, (N,); not a number where there is none.
        actions: Test of each joint whether anything acts beyond the actuator, (n,).
        source: Name of the recording.
        period: Mean period of the gait [s]; None if nothing repeats.
        phase_source: What begins a cycle; "" for no phase.
        findings: What else than a wearer may explain the torque, and where the estimate is not supported by data.
        filter: Filter of the torque.
        units: Units of each joint, (n,).
    """

    joint_names: tuple[str, ...]
    time: FloatArray
    torque: FloatArray
    band: FloatArray
    velocity: FloatArray
    phase: FloatArray
    actions: tuple[JointAction, ...]
    source: str
    period: float | None = None
    phase_source: str = ""
    findings: tuple[Finding, ...] = ()
    filter: TorqueFilter = field(kw_only=True)
    units: tuple[PositionUnit, ...] = field(kw_only=True)

    @property
    def worn(self) -> bool | None:
        """Whether something acts beyond noise, model error and a constant torque; None if that cannot be told.

        A recording without a wearer is called worn with a probability of at most 1 %; see :func:`.action.judge`.
        """
        wrong = {finding.kind for finding in self.findings if finding.severity == "error"}
        if wrong - {"rough-estimate"}:
            return None
        return any(action.acts for action in self.actions) or (None if wrong or self.unclear else False)

    @property
    def unclear(self) -> tuple[str, ...]:
        """Joints of which much is outside the band about the mean, but below the least that the test would notice."""
        outside = (np.abs(self.torque - self.mean) > self.band).mean(axis=0)
        tested = zip(self.joint_names, outside, self.actions, strict=True)
        # Outside are at most 0.11 of an unworn log (`scripts/study_interaction.py --unworn --seeds 3`), and 0.2 where
        # residuals are 1.5 times as large.
        return tuple(name for name, share, one in tested if share > 0.25 and one.p_value >= 0.0 and not one.acts)

    @property
    def rms(self) -> FloatArray:
        """RMS torque [N·m], (n,); not a number for a joint whose torque was not measured."""
        return np.asarray(np.sqrt((self.torque**2).mean(axis=0)))

    @property
    def peak(self) -> FloatArray:
        """Largest size of the torque [N·m], (n,)."""
        return np.asarray(np.abs(self.torque).max(axis=0))

    @property
    def mean(self) -> FloatArray:
        """Mean torque [N·m], (n,)."""
        return np.asarray(self.torque.mean(axis=0))

    @property
    def power(self) -> FloatArray:
        """Mean power of the wearer on the leg [W], (n,); positive where the wearer drives the leg."""
        return np.asarray((self.torque * self.velocity).mean(axis=0))

    @property
    def outside_band(self) -> FloatArray:
        """Share of the samples whose band does not contain zero, (n,): about 5 % where nothing acts."""
        outside = (np.abs(self.torque) > self.band).astype(np.float64)
        return np.asarray(np.where(np.isnan(self.torque), np.nan, outside).mean(axis=0))

    def by_phase(self) -> GaitProfile:
        """Average torque and power over the phase of the gait.

        Returns:
            Mean and RMS torque and mean power in each twentieth.

        Raises:
            ExoidError: The motion does not repeat.
        """
        if np.isnan(self.phase).all():
            raise NotIdentifiableError(
                "the motion has no period that was found, and no touch-down",
                where=self.source,
                remedy="give the times at which strides begin: interaction(est, recording, strides=[...])",
            )
        return profile(self.torque, self.velocity, self.phase)

    def to_json(self) -> dict[str, Any]:
        """Turn the figures of an interaction into what JSON can hold.

        Returns:
            Figures of each joint, whether the leg is worn, and the findings.
        """
        means = (self.rms, self.peak, self.outside_band, self.mean, self.power)
        joints = {}
        columns = (self.joint_names, *means, self.actions, self.units)
        for name, rms, peak, outside, mean, power, action, unit in zip(*columns, strict=True):
            figures = {"rms": rms, "peak": peak, "outside_band": outside, "mean": mean, "power": power}
            figures |= {"p_value": action.p_value, "least_rms": action.least}
            joints[name] = json_value(figures) | {"acts": None if name in self.unclear else action.acts}
            joints[name]["torque_unit"] = unit.torque
        data: dict[str, Any] = {"joints": joints, "worn": self.worn, "level": LEVEL, "source": self.source}
        data |= {"samples": len(self.time), "cutoff": self.filter.cutoff}
        if self.period is not None:
            found = self.by_phase()
            torques = {
                name: {key: json_value(getattr(found, key)[:, j]) for key in ("mean", "rms", "power")}
                for j, name in enumerate(self.joint_names)
            }
            begins = {"period": self.period, "begins": self.phase_source, "phase": found.phase.tolist()}
            data["gait"] = begins | {"joints": torques}
        return data | {"findings": json_value(self.findings)}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the torque over time, with half the width of its band, velocity, and the phase if there is one.

        Args:
            path: File to write. Columns are ``time``, ``interaction_<joint>``, ``band_<joint>``, ``v_<joint>`` and
                ``phase``, "nan" where a torque was not measured or the phase is not known.

        Raises:
            ExoidError: The file cannot be written.
        """
        header = ["time", *(f"{kind}_{name}" for kind in ("interaction", "band", "v") for name in self.joint_names)]
        table = np.column_stack([self.time, self.torque, self.band, self.velocity])
        if not np.isnan(self.phase).all():
            header, table = [*header, "phase"], np.column_stack([table, self.phase])
        what = f"torque of the wearer on the leg [{heading(self.units, '{torque}')}]"
        write_csv(path, header, table, [f"# exoid interaction: {self.source}; {what}"])

    def __repr__(self) -> str:
        """Say whether the leg is worn, and name the joints and their RMS torque."""
        each = zip(self.joint_names, self.rms, (unit.torque for unit in self.units), strict=True)
        sizes = ", ".join(f"{name} not measured" if np.isnan(x) else f"{name} {x:.3g} {unit}" for name, x, unit in each)
        worn = {True: "worn", False: "not worn", None: "worn or not"}[self.worn]
        return f"Interaction({worn}; rms: {sizes})"

    def _report(self) -> list[DataTable | str]:
        """Title, tables, findings and conclusion."""
        phase = "" if self.period is None else f"; a cycle of {self.period:.3g} s begins at the {self.phase_source}"
        acting = ", ".join(name for name, action in zip(self.joint_names, self.actions, strict=True) if action.acts)
        conclusion = f"worn: something acts on {acting}" if acting else "not worn: nothing beyond model error"
        if self.worn is None:
            names = ", ".join(self.unclear)
            why = f"much of {names} is outside the band, but below the least that the test tells from model errors"
            if any(finding.severity == "error" for finding in self.findings):
                why = "the errors above must be mended before it can be told"
            conclusion = f"worn or not: {why}"
        return [
            f"Torque of the wearer on the leg in {self.source}",
            make_table(self.headers, self.rows()),
            f"{len(self.time)} samples, {self.filter}{phase}",
            *map(str, self.findings),
            f"{conclusion} (false alarms: at most {LEVEL:.0%} of recordings)",
        ]

    @property
    def headers(self) -> tuple[str, ...]:
        """Columns of :meth:`rows`; the last is the smallest RMS that the test would notice."""
        sizes = (f"{name} [{heading(self.units, '{torque}')}]" for name in ("RMS", "peak", "mean"))
        return ("joint", *sizes, "power [W]", "outside band", "p", "acts", "least")

    def rows(self) -> list[tuple[str, ...]]:
        """Write the figures of each joint as a row of a table.

        Returns:
            One row a joint.
        """
        columns = (self.joint_names, self.rms, self.peak, self.mean, self.power, self.outside_band, self.actions)
        rows: list[tuple[str, ...]] = []
        for name, rms, peak, mean, power, outside, action in zip(*columns, strict=True):
            if np.isnan(rms):
                rows.append((name, "not measured", *[""] * (len(self.headers) - 2)))
                continue
            tested: tuple[str, ...] = ("not tested", "", "")
            if not np.isnan(action.p_value):
                p_value = f"{action.p_value:.2g}" if action.p_value >= 1e-6 else "< 1e-06"
                acts = "yes" if action.acts else "unclear" if name in self.unclear else "no"
                tested = p_value, acts, f"{action.least:.2g}"
            rows.append((name, *(f"{value:.4g}" for value in (rms, peak, mean, power)), f"{outside:.1%}", *tested))
        return rows


def interaction(
    estimate: EstimateData,
    recording: Recording,
    *,
    strides: ArrayLike | None = None,
    cutoff: float | None = None,
    actuators: Mapping[str, Drive | Coupling] | Actuators | None = None,
) -> Interaction:
    """Compute the torque between wearer and exoskeleton at each joint, with a band, and test whether anything acts.

    τ_w = W β − τ is what the joints need and the actuators do not give. Both sides pass the filter of the estimate.
    The base may be fixed, tilted or moving. Where a link stands on the ground, its wrench has to be measured; other
    samples are left out.

    Args:
        estimate: Estimate of the leg without a wearer.
        recording: Motion with torques, or with currents and drives.
        strides: Times at which strides begin [s]; None for touch-downs or the period of the motion.
        cutoff: Cut-off frequency of both torques [Hz]; None for the estimate's own preparation.
        actuators: Drives of the recording, as for :func:`exoid.identify`; None for those of the estimate.

    Returns:
        Torque over time with its band, figures of each joint, the test, and findings.

    Raises:
        ExoidError: The recording lacks a joint or any torque, is too short for the filter, or stands on the ground
            throughout by unknown wrenches.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> found = exoid.interaction(exoid.identify(data.leg, data.train), data.test)
        >>> found.worn
        False
    """
    estimate, ((recording, changed),), chosen = to_predict(estimate, [recording], actuators, cutoff)
    recording = estimate.model.select(recording)
    name, measured = recording.file_name, recording.measured
    even, preparation = recording.resampled(), chosen.preparation
    rate = even.sample_rate
    fraction = preparation.independent_fraction(rate)
    bandwidth = fraction / estimate.preparation.independent_fraction(rate)
    found = evaluate(estimate, recording, preparation, bandwidth)
    used = np.clip(np.searchsorted(even.time, found.time - 0.5 / rate), 0, len(even) - 1)
    torque = np.where(measured, found.torque, np.nan)
    joints = range(len(estimate.joint_names))
    effective = len(found.time) * fraction * np.array([effective_share(estimate, joint) for joint in joints])
    behind = [noise.effective_samples for noise in estimate.noise] or [estimate.dof] * len(joints)
    evidence = Evidence(  # joints without torque in the training are not tested
        np.where(estimate.trained, torque.var(axis=0), np.nan),
        torque.mean(axis=0),
        np.where(estimate.trained, found.noise, 0.0),
        np.maximum(found.variance.mean(axis=0) - found.noise, 0.0),
        effective,
        np.maximum(behind, 1.0),
    )
    actions = judge(evidence)
    phase, period, begins = find_phase(even, strides)
    findings = [
        *channel_findings(recording),
        *changed,
        *extrapolations(estimate, found.ranges),
        *unmeasured_torques(estimate, measured),
        *too_few_samples(estimate, evidence),
        *rough_estimate(estimate, found.predicted),
        *constant_torques(estimate, evidence, actions),
        *explanations(estimate, found, actions),
    ]
    return Interaction(
        estimate.joint_names,
        found.time,
        torque,
        half_width(0.95, estimate.dof) * np.sqrt(found.variance),
        np.array(preparation.kinematics(even).v[used]),
        np.array(phase[used]),
        actions,
        name or "array",
        period,
        begins,
        findings=ordered([replace(one, recording=name) for one in findings]),
        filter=chosen,
        units=position_units(estimate.model.leg),
    )
