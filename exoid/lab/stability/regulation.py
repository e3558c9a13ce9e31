"""Regulation to a constant target with partial, exact and excessive friction compensation (doc. 2, sec. IV-B)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.friction import FrictionCompensation
from exoid.control.law import RATE, gains
from exoid.control.laws import gravity_friction_pd
from exoid.control.side_by_side import compare_laws
from exoid.control.tracking import Tracking
from exoid.errors import BadArgumentError
from exoid.experiments import Hold
from exoid.rig import Plant
from exoid.tools.json_values import attributes, json_value
from exoid.tools.tables import make_table, to_text

from .rest import Equilibrium, LimitCycle, find_equilibrium, find_limit_cycle


@dataclass(frozen=True, eq=False, repr=False)
class Regulation:
    """One run from rest towards a constant target."""

    name: str  # friction compensation of this run
    run: Tracking  # the run
    equilibrium: Equilibrium  # predicted rest position
    cycle: LimitCycle  # oscillation at the end

    @property
    def final_error_deg(self) -> FloatArray:
        """Distance from the target at the end [deg], (n,)."""
        return np.asarray(np.rad2deg(self.run.error[-1]))

    @property
    def stopped(self) -> bool:
        """Whether the leg rests during the whole last part, and not only for a moment as it reverses."""
        # Share of the run, at its end, during which a stopped leg rests.
        begin = int((1.0 - 0.1) * len(self.run.time))
        return bool((np.abs(self.run.v[begin:]) < 1e-6).all())  # velocity below which a joint rests [rad/s]

    @property
    def outcome(self) -> str:
        """Outcome in two or three words."""
        if self.stopped:
            return "stops" if self.equilibrium.holds(self.run.q[-1]) else "stops elsewhere"
        return "limit cycle" if self.cycle.exists else "still settling"

    def to_json(self) -> dict[str, Any]:
        """Convert the results of the run to JSON types."""
        return {
            **attributes(self, "outcome", "final_error_deg"),
            "band_deg": json_value(np.rad2deg(self.equilibrium.band)),
            **attributes(self.cycle, "peak_to_peak_deg"),
        }


@dataclass(frozen=True, eq=False, repr=False)
class Regulations:
    """Several regulation runs; prints itself as a table."""

    runs: tuple[Regulation, ...]  # one run without any friction, then one for each compensated share
    kp: FloatArray  # gains Kp [N·m/rad], (n,)
    kd: FloatArray  # gains Kd [N·m·s/rad], (n,)
    rate: float  # sampling rate of the controller [Hz]

    def __getitem__(self, name: str) -> Regulation:
        """Look up a run by its name."""
        for run in self.runs:
            if run.name == name:
                return run
        raise BadArgumentError(f"no run {name!r}", remedy=f"there are {', '.join(run.name for run in self.runs)}")

    def to_json(self) -> dict[str, Any]:
        """Convert the table to JSON types."""
        return {
            **attributes(self, "kp", "kd"),
            "rate_hz": self.rate,
            "runs": {run.name: run.to_json() for run in self.runs},
        }

    def __repr__(self) -> str:
        """Name outcomes."""
        return f"Regulations({', '.join(f'{run.name}: {run.outcome}' for run in self.runs)})"

    def __str__(self) -> str:
        """Print as a table."""
        rows = [
            (
                run.name,
                run.outcome,
                " / ".join(f"{x:.2f}" for x in run.final_error_deg),
                " / ".join(f"{x:.2f}" for x in np.rad2deg(run.equilibrium.band)),
                " / ".join(f"{x:.1f}" for x in run.cycle.peak_to_peak_deg),
            )
            for run in self.runs
        ]
        headers = ("friction", "outcome", "last error [deg]", "band [deg]", "swing [deg p-p]")
        first = self.runs[0]
        away = " / ".join(f"{x:.0f}°" for x in np.rad2deg(-first.run.error[0]))
        kp, kd = (" / ".join(f"{x:g}" for x in values) for values in (self.kp, self.kd))
        return to_text(
            f"{' / '.join(first.run.joint_names)}: from {away} off the target in {first.run.time[-1]:g} s",
            f"PD with exact gravity and × friction compensation: Kp {kp} N·m/rad, Kd {kd} N·m·s/rad, {self.rate:g} Hz",
            make_table(headers, rows),
            "band: c0 / Kp, in which stiction may hold the leg",
        )


def regulate(
    plant: Plant,
    kp: ArrayLike,
    kd: ArrayLike,
    target: ArrayLike,
    away: ArrayLike,
    *,
    shares: Sequence[float] = (0.0, 0.5, 0.8, 1.0, 1.2, 1.5),
    rate: float = RATE,
    duration: float = 20.0,
    progress: Callable[[float], None] | None = None,
) -> Regulations:
    """Regulate a leg to a target under PD with exact gravity compensation and several shares of friction compensation.

    Friction is compensated with the sign function of the measured velocity, as doc. 2, eq. (25), prints it. Doc. 2
    proves stability for exact compensation of gravity and friction, in continuous time. With stiction and exact or
    less compensation, the leg stops within c0 / Kp of the target. With too much, it never stops.

    Args:
        plant: The true leg, one rig with friction.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        target: Constant target θ_d [rad], (n,).
        away: Start minus target [rad], (n,).
        shares: Compensated shares of the friction.
        rate: Sampling rate of the controller [Hz].
        duration: Duration of each run [s].
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        All runs; the first, "no friction", is that of the leg without friction.

    Raises:
        ExoidError: The plant has several rigs, or a setting is invalid.
    """
    stiffness, damping = (np.broadcast_to(gains(x, name), plant.n) for x, name in ((kp, "kp"), (kd, "kd")))
    aim = np.array(target, dtype=np.float64).reshape(-1)
    start = aim + np.asarray(away, dtype=np.float64).reshape(-1)
    zero = np.zeros_like(plant.coulomb)
    smooth = replace(plant, coulomb=zero, static=zero, viscous=zero)
    laws = {"no friction": gravity_friction_pd(smooth, stiffness, damping, friction=None, rate=rate)}
    for share in shares:
        sharp = FrictionCompensation(width=0.0, scale=share)
        laws[f"× {share:g}"] = gravity_friction_pd(plant, stiffness, damping, friction=sharp, rate=rate)
    plants = dict.fromkeys(laws, plant) | {"no friction": smooth}
    log = rate * ceil(100.0 / rate)
    runs = compare_laws(plants, laws, Hold(aim[:, None]), duration, start=start, log_rate=log, progress=progress)
    return Regulations(
        tuple(
            Regulation(
                name,
                run,
                find_equilibrium(plants[name], laws[name], aim),
                find_limit_cycle(run, 0.25),  # share of the run, at its end, that is searched for oscillations
            )
            for name, run in runs.items()
        ),
        stiffness,
        damping,
        rate,
    )
