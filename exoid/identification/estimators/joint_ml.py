"""Joint maximum likelihood: the motion and the parameters at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.identification.problem import Problem
from exoid.regression.fit import correlated_uncertainty, has_torque, wls
from exoid.regression.problem import Fit
from exoid.regression.residuals import fit_noise
from exoid.signals import Poses, Recording, ZeroPhase, choose_preparation
from exoid.signals.filters.reversals import around_stops
from exoid.signals.moving_base import base_during
from exoid.torques import TorqueModel
from exoid.torques.terms import DryFriction

from .motion_fit import MotionFit, fit_motion
from .motion_system import Levels, Moving

LADDER = math.sqrt(2.0)  # ratio of one knot spacing that is tried to the next
FINEST = 2.0  # knots of the ladder are at least so many samples apart
CLOSEST = 1.5  # knots closer than so many samples are refused: measurements would not hold the motion
QUIET = 1e-9  # noise below this [rad], or part of the torque, is rounding
ROUGHLY = 0.05  # what SETTLED is on a rung of the ladder


@dataclass(frozen=True)
class JointML:
    """Joint maximum likelihood of motion and parameters.

    Each joint's angle is a quintic spline q(t). Spline and parameters together minimise

        Σ (q_t − q(t))² / σ_q² + Σ (τ_t − W(q(t), q̇(t), q̈(t)) β)² / σ_τ²

    over unfiltered samples, with σ_q and σ_τ of each joint estimated too. The torque thus helps to find the motion, and
    noise in the angles does not bias β as it does where W is formed from angles as measured. Most precise if the noise
    of angles and of torques is white; intervals allow for correlated noise of both. No controller needs to be known.
    Recorded velocities and accelerations are not used. Where Coulomb friction has a sharp sign, it is smoothed over
    0.01 rad/s; samples in a dead band, and at reversals that wls takes out too, count as angles, not as torques.

    Attributes:
        spacing: Spacing of the knots [s]; None to try a geometric ladder and take the one below that which generalised
            cross-validation prefers: a little more variance, but no bias that intervals do not know of.
    """

    fits_samples: ClassVar[bool] = True  # no filter makes rows, so that neither cut-off nor preparation applies
    spacing: float | None = None

    def __post_init__(self) -> None:
        """Check the spacing."""
        if self.spacing is not None and not 0.0 < self.spacing < math.inf:
            what = f"knots every {self.spacing} s"
            raise BadArgumentError(what, remedy="give a positive spacing in seconds, or None")

    @property
    def name(self) -> str:
        """``"ml"``, with the spacing if it is given."""
        return "ml" if self.spacing is None else f"ml(spacing={self.spacing:.4g})"

    def __call__(self, problem: Problem) -> Fit:
        """Start from weighted least squares on filtered rows, and fit.

        Terms with memory or load, close knots, payloads and several groups are refused.
        """
        group, terms = problem.single, problem.single.model.terms
        if type(group.model) is not TorqueModel or any(one.loaded or one.internal_state is not None for one in terms):
            raise NotSupportedError("ml takes no friction that remembers or depends on load", remedy="use wls or huber")
        for data in group.data:
            lacks = "poses" if isinstance(data, Poses) else ", ".join(map(str, data.payloads))
            if isinstance(data, Recording) and not lacks:
                links = [link for link, wrench in data.wrenches.items() if wrench.columns.any()]
                links += [link for link, contact in data.contacts.items() if contact.any() and link not in links]
                lacks = f"what acts on {', '.join(links)}" if links else ""
            if lacks:
                what = f"ml fits motions of the leg in the air, without {lacks}"
                raise NotSupportedError(what, where=data.file_name, remedy="use wls, huber or ols")
        first = wls(problem)
        model = smooth(group.model)
        preparation = choose_preparation([group.model.select(data) for data in group.motions])
        moving = [_moving(group.model, data, preparation) for data in group.motions]
        # Noise of a passive joint is not seen; below what ordinary least squares leave, its parameters would go to zero
        quiet = QUIET * max(float(np.abs(data.tau).max()) for data in moving)
        torque = np.where(has_torque(problem), quiet, 1.0 / np.array(first.weights))
        least = Levels(np.full_like(torque, QUIET), torque)
        priors = problem.prior_knowledge.pseudo_rows(problem.names)
        fit = partial(fit_motion, model, solve=problem.solve, priors=priors, least=least)
        start = first if preparation == group.preparation else wls(problem.changed(preparation=preparation))
        values, spacing = start.solution.values, self.spacing
        interval = max(float(np.median(np.diff(data.time))) for data in moving)
        if spacing is None:
            rough = _best(fit, moving, values, FINEST * interval * (1.0 - 1e-9))
            moving, values, spacing = _on(moving, rough), rough.solution.values, rough.spacing
            if spacing / LADDER >= FINEST * interval * (1.0 - 1e-9):
                spacing /= LADDER
        elif spacing < CLOSEST * interval * (1.0 - 1e-9):
            what = f"knots every {spacing:g} s are closer than {CLOSEST:g} samples"
            raise BadArgumentError(what, remedy=f"choose a spacing of at least {CLOSEST * interval:.3g} s, or None")
        found = fit(moving, values=values, spacing=spacing)
        # noise is that of the filtered rows too, as for other estimators
        solution = found.solution._replace(inverse=first.solution.inverse, prior_noise=first.solution.prior_noise)
        noises = fit_noise(problem, Fit(solution, first.weights), solution.covariance)
        warnings = () if found.converged else ("the joint fit of motion and parameters has not converged: prefer wls",)
        rows = found.system.influence(found.state, found.levels)  # noise of angles and torques may be correlated
        uncertainty = correlated_uncertainty(rows, Fit(found.solution, [1.0]))._replace(noises=noises)
        name = f"ml(spacing={found.spacing:.4g})"
        return Fit(solution, first.weights, warnings=warnings, uncertainty=uncertainty, name=name)


def smooth(model: TorqueModel) -> TorqueModel:
    """The same model with friction that can be differentiated: a sharp sign is one over 0.01 rad/s."""
    terms = (
        replace(term, smoothing=term.smoothing or 0.01, dead_band=0.0) if isinstance(term, DryFriction) else term
        for term in model.terms
    )
    return TorqueModel(model.leg, tuple(terms), separate=model.separate)


def _moving(model: TorqueModel, recording: Recording, preparation: ZeroPhase) -> Moving:
    recording = replace(model.select(recording).resampled(), v=None, a=None)
    q, v, _, _ = preparation.kinematics(recording)
    usable = model.usable(v).astype(np.float64)
    slow, parallel = model.reversing(v), preparation.parallel(recording.sample_rate)
    if slow is not None and parallel is not None:  # friction is unknown there
        usable *= ~around_stops(slow, parallel)
    if recording.mask is not None:
        usable *= recording.mask[:, None]
    base = base_during(recording, preparation)
    return Moving(recording.time, recording.q, np.asarray(recording.tau), usable, q, base)


def _on(moving: Sequence[Moving], found: MotionFit) -> list[Moving]:
    """Begin with the motions that were found."""
    return [data._replace(smooth=q) for data, q in zip(moving, found.motions, strict=True)]


def _best(fit: Callable[..., MotionFit], moving: Sequence[Moving], values: FloatArray, finest: float) -> MotionFit:
    """Walk along the ladder of spacings, finer or else coarser, as long as the criterion falls."""
    best = first = fit(moving, values=values, spacing=max(0.04, finest), settled=ROUGHLY)  # [s]
    for ratio in (1.0 / LADDER, LADDER):
        here = first.spacing * ratio
        while finest <= here <= 0.64:  # largest knot spacing that is tried [s]
            found = fit(_on(moving, best), values=best.solution.values, spacing=here, settled=ROUGHLY)
            if not found.criterion < best.criterion:
                break
            best, here = found, here * ratio
        if best is not first:
            break
    return best
