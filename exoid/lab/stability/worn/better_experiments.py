"""Experiments that would raise the largest stable amplification, by the covariance that each predicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.sensitivity_amplification import sensitivity_amplification
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments.excitation import MotionLimits, Plan, plan_excitation
from exoid.experiments.excitation.precision import StaticRows, information_of
from exoid.experiments.excitation.scales import TorqueNoise
from exoid.rig import Wearer
from exoid.signals import Recording
from exoid.tools.tables import make_table, to_text

from .amplification import MOST, Amplification, AmplifiedLaw, amplification_of_draws
from .worn_loop import WornLoop, poses_of

HIGHEST = {"slow": 0.3, "walking speed": 1.0, "fast": 2.0}
"""Highest frequency of the candidate motions [Hz]."""

TILTS = (-20.0, 20.0)
"""Torso tilts of one more candidate [deg]."""

Experiment = Plan | Sequence[Recording | StaticRows]
"""A planned motion, or motions and poses."""


@dataclass(frozen=True, eq=False, repr=False)
class BetterExperiments:
    """Largest amplification now and after each of several experiments; prints itself as a table."""

    now: Amplification  # result with the covariance of the estimate
    after: dict[str, Amplification]  # predicted results by the name of the experiment
    noise: TorqueNoise  # torque noise of the prediction

    @property
    def best(self) -> str | None:
        """Experiment that raises the largest amplification most; None if none raises it."""
        name = max(self.after, key=lambda name: self.after[name].largest)
        return name if self.after[name].largest > self.now.largest else None

    def to_json(self) -> dict[str, Any]:
        """Convert the results to JSON types."""
        after = {name: found.to_json() for name, found in self.after.items()}
        return {"now": self.now.to_json(), "after": after, "best": self.best, "noise": list(self.noise.std)}

    def __repr__(self) -> str:
        """Name the best experiment."""
        return f"BetterExperiments({len(self.after)} experiments, best: {self.best})"

    def __str__(self) -> str:
        """Print as a table."""
        results = {"none": self.now, **self.after}
        rows = [
            (name, _text(found.largest), " to ".join(map(_text, found.interval)), str(found.limited_by))
            for name, found in results.items()
        ]
        table = make_table(("experiment to add", "largest amplification", "Monte-Carlo 95 %", "limited by"), rows)
        exact = f"with an exact model: {_text(self.now.exact)}, which no experiment can raise"
        return to_text(table, exact, f"torque noise {self.noise}")


def better_experiments(
    estimate: Estimate,
    *,
    wearer: Wearer | None = None,
    experiments: Mapping[str, Experiment] | None = None,
    noise: ArrayLike | None = None,
    noise_bandwidth: float | None = None,
    duration: float = 60.0,
    law: AmplifiedLaw = sensitivity_amplification,
    poses: ArrayLike | None = None,
    delay: int = 0,
    share: float = 0.95,
    draws: int = 100,
    most: float = MOST,
    seed: int = 0,
) -> BetterExperiments:
    """Predict the largest stable amplification after each of several experiments.

    An experiment of information I (:func:`exoid.experiments.excitation.precision.predict`) changes the covariance to
    Σ' = (1 + Σ I)⁻¹ Σ. The draws are made again from N(β̂, Σ') with the same random numbers.

    Args:
        estimate: Estimate that the controller uses.
        wearer: The wearer; None for nobody.
        experiments: Experiments to compare, by name; None for motions of ``exoid plan`` within the limits of the leg:
            slow, at walking speed, fast, and with tilted torso.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for the residuals of the estimate.
        noise_bandwidth: Bandwidth of the noise [Hz]; None for the cut-off of the estimate with its residuals, else
            white.
        duration: Duration of each default motion [s].
        law: See :func:`largest_amplification`.
        poses: Likewise.
        delay: Likewise.
        share: Likewise.
        draws: Likewise.
        most: Likewise.
        seed: Seed of the draws and of the search for motions.

    Returns:
        Predicted results.

    Raises:
        ExoidError: There is no experiment, a motion cannot be planned, or see :func:`largest_amplification`.
    """
    if experiments is not None and not experiments:
        raise BadArgumentError("no experiments to compare", remedy="leave experiments out for planned motions")
    of_noise = _noise(estimate, noise, noise_bandwidth)
    candidates = _planned(estimate, of_noise, duration, seed) if experiments is None else experiments
    at = poses_of(estimate.leg, poses)
    loop = WornLoop.of_amplifications(lambda amplification: law(estimate, amplification), wearer, at, delay, most)

    def evaluate(covariance: FloatArray) -> Amplification:
        """Find the stable amplification for a covariance of the estimate."""
        return amplification_of_draws(loop, estimate, covariance, share, draws, most, seed)

    after = {name: evaluate(covariance_after(estimate, each, of_noise)) for name, each in candidates.items()}
    return BetterExperiments(evaluate(estimate.covariance), after, of_noise)


def covariance_after(estimate: Estimate, experiment: Experiment, noise: TorqueNoise) -> FloatArray:
    """Predict the covariance of an estimate after one more experiment."""
    model = estimate.model.loaded_by(estimate.values)
    data: Sequence[Recording | StaticRows] = (
        experiment
        if not isinstance(experiment, Plan)
        else (
            *experiment.recordings,
            *map(StaticRows, experiment.poses),
        )
    )
    R, scores, _ = information_of(model, data, noise, estimate.preparation)
    scale = np.linalg.norm(R, axis=0)
    scale = np.where(scale > 0.0, 1.0 / np.where(scale > 0.0, scale, 1.0), 1.0)
    normal = (R * scale).T @ (R * scale)
    information = normal @ np.linalg.pinv(scores * np.outer(scale, scale), hermitian=True) @ normal  # scaled
    prior = estimate.covariance / np.outer(scale, scale)
    later = np.linalg.solve(np.eye(len(prior)) + prior @ information, prior) * np.outer(scale, scale)
    return np.asarray(0.5 * (later + later.T))


def _noise(estimate: Estimate, noise: ArrayLike | None, bandwidth: float | None) -> TorqueNoise:
    """Given noise; or noise with the rms of the filtered residuals up to the cut-off of the filter."""
    cutoff = getattr(estimate.preparation, "cutoff", None)
    std = estimate.residual_rms if noise is None else noise
    default = np.inf if noise is not None or cutoff is None else float(cutoff)
    return TorqueNoise.of(std, np.ones(len(estimate.joint_names)), default if bandwidth is None else bandwidth)


def _planned(estimate: Estimate, noise: TorqueNoise, duration: float, seed: int) -> dict[str, Plan]:
    """Motions within the limits of the leg."""
    leg, terms = estimate.model.leg, estimate.model.terms
    limits = MotionLimits.of(leg)
    values = dict(zip(estimate.names, estimate.values.tolist(), strict=True))

    def plan(highest: float, tilts: Sequence[float]) -> Plan:
        """Plan a motion up to a frequency [Hz], with tilts of the torso [rad]."""
        return plan_excitation(
            leg,
            terms,
            duration=duration,
            highest=highest,
            tilts_deg=tilts,
            limits=limits,
            noise=noise.std,
            noise_bandwidth=noise.bandwidth,
            values=values,
            starts=2,  # starts of the search for each candidate
            seed=seed,
        )

    plans = {f"{name}, {duration:g} s up to {highest:g} Hz": plan(highest, (0.0,)) for name, highest in HIGHEST.items()}
    if leg.chain is not None:
        plans[f"torso at {TILTS[0]:+g}° and {TILTS[1]:+g}°, {duration:g} s up to 1 Hz"] = plan(1.0, TILTS)
    return plans


def _text(amplification: float) -> str:
    return "no limit" if np.isinf(amplification) else f"{amplification:.3g}"
