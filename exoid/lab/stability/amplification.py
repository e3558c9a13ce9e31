"""Largest stable amplification of a law worn by a person, over the distribution of an estimate or for given truths."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import AnyLaw
from exoid.control.model import ControlModel, ModelSource
from exoid.control.sensitivity_amplification import sensitivity_amplification
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.rig import Plant, Wearer
from exoid.tools.json_values import attributes, json_value
from exoid.tools.tables import to_text

from .draws import draw_truths
from .worn_leg import HeldLeg
from .worn_loop import WornLoop, poses_of

AmplifiedLaw = Callable[[Any, float], AnyLaw]
"""Function that makes a controller from the source of its model and an amplification."""


@dataclass(frozen=True, eq=False, repr=False)
class Amplification:
    """Largest stable amplifications of many true legs under one controller; prints itself.

    Attributes:
        leg: Name of the leg.
        values: Largest stable amplification of each draw or truth, (B,): 0 if even 1 is unstable, inf if all up to
            ``most`` are stable.
        exact: Largest stable amplification with an exact model: what filter, rate, delay and wearer allow.
        share: Share of the draws that must be stable.
        pose: Pose at which the loop first becomes unstable [rad], (n,); empty if it does not.
        frequency: Frequency of the oscillation at that boundary [Hz]; NaN without one.
        rejected: Share of draws that no rigid bodies have.
        drawn: Whether the true legs are draws from the distribution of an estimate.
        rate: Sampling rate of the controller [Hz].
        delay: Delay of the readings in sampling periods.
        most: Largest amplification tried.
    """

    leg: str
    values: FloatArray
    exact: float
    share: float
    pose: FloatArray
    frequency: float
    rejected: float
    drawn: bool
    rate: float
    delay: int
    most: float

    @property
    def largest(self) -> float:
        """Largest amplification that is stable for ``share`` of the draws; 0 if none is, inf if all tried are."""
        return float(np.sort(self.values)[_rank(len(self.values), self.share)])

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of :attr:`largest` for the finite number of draws, by order statistics."""
        count, ordered = len(self.values), np.sort(self.values)
        below, above = (int(scipy.stats.binom.ppf(p, count, 1.0 - self.share)) for p in (0.025, 0.975))
        return float(ordered[max(below - 1, 0)]), float(ordered[min(above, count - 1)])

    def to_json(self) -> dict[str, Any]:
        """Convert the result to JSON types.

        Returns:
            Values by name; None stands for an amplification without limit, see ``most``.
        """
        names = ("leg", "largest", "interval", "exact", "share", "rejected", "drawn", "rate", "delay", "most")
        data = attributes(self, *names, "frequency")
        return data | {"pose_deg": json_value(np.rad2deg(self.pose)), "draws": len(self.values)}

    def __repr__(self) -> str:
        """Write the largest amplification."""
        return f"Amplification({self.leg}: {_text(self.largest, self.most)})"

    def __str__(self) -> str:
        """Print the result with its evidence."""
        low, high = (_text(each, self.most) for each in self.interval)
        count, found = len(self.values), _text(self.largest, self.most)
        if self.drawn:
            head = f"{found}, stable for {100.0 * self.share:g} % of {count} draws (Monte-Carlo 95 %: {low} to {high})"
        elif count == 1:
            head = f"{found} for the given true leg"
        else:
            head = f"{found}, stable for {100.0 * self.share:g} % of {count} given legs"
        parts = [f"{self.leg}: largest amplification {head}"]
        parts.append(f"with an exact model: {_text(self.exact, self.most)}")
        if len(self.pose):
            pose = ", ".join(f"{x:.0f}°" for x in np.rad2deg(self.pose))
            # Frequency below which a growing motion is a drift [Hz].
            grows = f"{self.frequency:.2g} Hz grow" if self.frequency > 0.1 else "the leg drifts away (its weight)"
            parts.append(f"beyond it, {grows} at the pose ({pose})")
        if self.rejected:
            parts.append(f"{100.0 * self.rejected:.2g} % of the draws were rejected: no bodies have these parameters")
        parts.append(f"{self.rate:g} Hz, delay {self.delay} sampling periods; linearised without Coulomb friction.")
        return to_text(*parts)


def largest_amplification(
    source: ModelSource,
    *,
    wearer: Wearer | None = None,
    truth: ModelSource | Sequence[ModelSource] | None = None,
    law: AmplifiedLaw = sensitivity_amplification,
    poses: ArrayLike | None = None,
    roles: Mapping[str, str] | None = None,
    delay: int = 0,
    share: float = 0.95,
    draws: int = 200,
    most: float = 100.0,
    seed: int = 0,
) -> Amplification:
    """Find the largest amplification at which a worn leg is stable, although the controller's model is not exact.

    The controller uses the estimate. The true parameters are drawn from the estimate's distribution N(β̂, Σ), or are
    given. For each of them the closed loop of leg, cuffs, limb, muscles, controller memory, hold and delay is
    linearised at several poses. It is stable if all eigenvalues have a modulus of at most 1. The search goes from 1
    upward to the first unstable amplification, because stability need not be monotone.

    Coulomb friction of the leg and its smooth compensation are left out: their slope is zero while joints move. Limits
    of the torque count as inactive. See ``docs/amplification.md``.

    Args:
        source: Source of the controller's model; an estimate unless ``truth`` is given.
        wearer: The wearer; None for nobody: then nothing but the controller holds the leg.
        truth: True legs; None for draws from the distribution of the estimate.
        law: Function that makes the controller from the source and an amplification.
        poses: Poses [rad], (N, n) or (n,), of which the worst counts; None for eight poses of a stride, within the
            limits of the joints.
        roles: "hip", "knee" or "ankle" for each joint that has another name, for the poses of a stride.
        delay: Delay of the readings in sampling periods.
        share: Share of the draws that must be stable.
        draws: Number of draws.
        most: Largest amplification that is tried.
        seed: Seed of the draws.

    Returns:
        Largest amplification with its evidence.

    Raises:
        ExoidError: The source has no covariance and no truth is given, a setting is invalid, or the controller has no
            derivatives at a pose.

    Example:
        >>> from exoid.experiments import Hold
        >>> leg = exoid.load_leg("cuhk")
        >>> lighter = leg.with_parameters(0.8 * leg.parameters)
        >>> wearer = Wearer.build(leg, intention=Hold(np.array([[0.2], [0.7]])))
        >>> largest_amplification(leg, truth=lighter, wearer=wearer, poses=[0.2, 0.7])
        Amplification(cuhk.urdf: 5.66)
    """
    model = ControlModel.of(source)
    if not (0.0 < share < 1.0 and draws >= 1 and 1.0 < most < np.inf):
        what = f"a share of {share:g}, {draws} draws, amplifications up to {most:g}"
        remedy = "give a share between 0 and 1, at least one draw, and a largest amplification above 1"
        raise BadArgumentError(what, remedy=remedy)
    at = poses_of(model.leg, poses, roles)
    loop = WornLoop.of_amplifications(lambda amplification: law(source, amplification), wearer, at, delay, most)
    rejected = 0.0
    if truth is not None:
        single = isinstance(truth, Estimate | Plant | ControlModel) or not isinstance(truth, Sequence)
        truths = [ControlModel.of(each) for each in ([truth] if single else truth)]  # type: ignore[arg-type, union-attr]
        legs, known = loop.legs_of(truths), loop.legs_of([model])
        values = loop.largest(legs)
    elif isinstance(source, Estimate):
        torques = source.model.loaded_by(source.values)
        parameters, rejected = draw_truths(torques, source.values, source.covariance, draws, seed)
        legs, known = loop.legs(torques, parameters), loop.legs(torques, source.values[None])
        values = loop.largest(legs)
    else:
        raise BadArgumentError("only an estimate has a distribution", remedy="pass an Estimate, or the truth")
    pose, frequency = _boundary(loop, legs, values, share)
    exact, name = float(loop.largest(known)[0]), model.leg.description.name
    drawn = truth is None
    return Amplification(name, values, exact, share, pose, frequency, rejected, drawn, loop.rate, loop.delay, most)


def _boundary(loop: WornLoop, legs: Sequence[HeldLeg], values: FloatArray, share: float) -> tuple[FloatArray, float]:
    """Pose and frequency at which the draw at the quantile becomes unstable."""
    which = int(np.argsort(values, kind="stable")[_rank(len(values), share)])
    if np.isinf(values[which]):
        return np.zeros(0), float("nan")
    at = np.array([1.0 - 1.0 / max(1.0, values[which])])
    each = loop.eigenvalues([leg.take(np.array([which])) for leg in legs], at)
    worst = int(np.argmax([np.abs(found).max() for found in each]))
    critical = each[worst][0, int(np.abs(each[worst][0]).argmax())]
    return loop.poses[worst], float(abs(np.angle(critical)) * loop.rate / (2.0 * np.pi))


def _rank(count: int, share: float) -> int:
    """Rank of the largest value that is stable for the share, from 0: at most 1 − share of the draws lie below it."""
    return min(count - 1, int(np.floor((1.0 - share) * count + 1e-9)))


def _text(amplification: float, most: float) -> str:
    if amplification == 0.0:
        return "none"
    return f"{amplification:.3g}" if np.isfinite(amplification) else f"above {most:g}"
