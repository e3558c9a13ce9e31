"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, TypedDict, overload

from exoid.actuators.constants import unknown_constants
from exoid.errors import BadArgumentError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.limbs import share_alike
from exoid.leg.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import Term

from .checkup import rounding_errors, with_noise_checked, without_delays
from .drive_constants import search_constants
from .drives import Drives
from .estimators import Estimator
from .estimators.by_name import find_estimator, fit_linear, name_of
from .findings.physics import with_negative
from .gather import begin, gather
from .group_rows import Measured
from .load_friction import fit_under_load
from .on_ground import fit_on_ground
from .problem import Fitted, Problem
from .result import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack


class FitOptions(TypedDict, total=False):
    """Options of :func:`identify` that all its forms have."""

    cutoff: float | None
    preparation: Preparation | str | None
    noise: str
    known: Mapping[str, float] | None
    prior: Prior | Mapping[str, tuple[float, float]] | None
    nonnegative: bool
    delay: str | None
    check: bool
    actuators: Drives | None
    alike: Sequence[str]


@overload
def identify(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: None = None,
    **options: Unpack[FitOptions],
) -> Estimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Mapping[str, Measured],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str] | None = None,
    **options: Unpack[FitOptions],
) -> GroupedEstimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str],
    **options: Unpack[FitOptions],
) -> GroupedEstimate: ...


def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str] | None = None,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
    delay: str | None = None,
    check: bool = True,
    actuators: Drives | None = None,
    alike: Sequence[str] = (),
) -> Estimate | GroupedEstimate:
    """Identify the parameters of a leg from recorded motions and torques (docs/identification.md).

    τ = W(q, v, a) β is formed for every sample. Columns and torque pass the same zero-phase low-pass, and β follows by
    least squares on R factors. Groups of recordings share some parameters: β = (shared, own of group 1, own of 2, …).

    Args:
        leg: The leg, of which only the geometry enters; or one for each group by its name, all of one design.
        recordings: Recordings or poses with torques, in memory or on disk; or by the name of their group.
        terms: Terms beside rigid-body dynamics; None for Coulomb and viscous friction, armature and offset.
        estimator: "wls" (weighted by residuals), "huber" (robust), "ml" (with noise in the angles), "ols", or an
            estimator, such as :class:`exoid.identification.estimators.JointML` or your function.
        own: Symbols ("offset") or names ("J1") that each group has of its own; each recording is a group unless groups
            have names. None for one group, or for all but the rigid bodies where groups have names.
        cutoff: Cut-off frequency of the low-pass [Hz]; None for at most 8 Hz, by the noise of the angles.
        preparation: Another way from a recording to rows, or its name; ``cutoff`` then does not apply.
        noise: "correlated" (by the residuals, also between joints) or "white" for the covariance.
        known: Values of parameters that are held fixed, by name; "c0_hip[left]" is that of one group. A known rotor of
            the first joint, "Ia_hip", is no part of J1 then.
        prior: Value and standard deviation of parameters, by name, or ``Prior.from_leg(leg, 0.2)``.
        nonnegative: Whether to bound friction and rotor inertia by zero.
        delay: "auto" to estimate by how much torques are late, and to shift them; None to leave them as they are.
        check: Whether to check logs and fit for faults, ``findings`` of the estimate (docs/checks.md), and for friction
            of other forms, which widens bands (``model_error``).
        actuators: Drives that turn currents, forces or motor angles of the recordings into torque: one for each joint
            by its name, such as :class:`exoid.actuators.Motor` (docs/drives.md); None for torques. Constants of drives
            that are not known are identified where something is known in N·m, such as a payload (docs/amperes.md).
        alike: Limbs of one machine that are of one design, or mirror images, by the beginning of their joints' names:
            ("left", "right"). A Wald test says which are equal; these share their parameters (docs/several-legs.md).

    Returns:
        The estimate; with groups, one for each with their joint covariance.

    Raises:
        ExoidError: Recordings are unfit, do not identify all parameters (names them), groups do not fit together, or
            the estimator cannot act on an argument.

    Example:
        >>> both = identify(leg, {"monday": a, "tuesday": b}, own="offset")  # doctest: +SKIP
    """
    if noise not in ("correlated", "white"):
        raise BadArgumentError(f"no noise {noise!r}", remedy="use one of correlated, white")
    if delay not in (None, "auto"):
        raise BadArgumentError(f"no delay {delay!r}", remedy="the only one is auto; or leave it out")
    chosen, by_noise = find_estimator(estimator), preparation is None and cutoff is None
    if preparation is not None and cutoff is not None:
        what = "cutoff is that of the parallel filter, which preparation replaces"
        raise BadArgumentError(what, remedy="pass one of them")
    if not by_noise and getattr(chosen, "fits_samples", False):
        given = "cutoff" if preparation is None else "preparation"
        what = f"{name_of(chosen)} fits samples as they were recorded, so that {given} does not apply"
        raise BadArgumentError(what, remedy=f"leave {given} out, or use wls")
    knowledge = PriorKnowledge(known or {}, prior if isinstance(prior, Prior) else Prior(prior or {}), nonnegative)
    if alike and (own is not None or isinstance(recordings, Mapping)):
        raise BadArgumentError("alike= is for limbs of one machine, and own= for groups", remedy="pass one of them")
    problem = begin(leg, recordings, terms, chosen, knowledge, own=own, actuators=actuators, delay=delay)
    problem = gather(problem, chosen, own=own, preparation=preparation, cutoff=cutoff, check=check)
    drives = problem.groups[0].actuators
    fit: Callable[[Problem, Estimator], Fitted] = fit_linear
    if any(one.stands for group in problem.groups for one in group.summaries):
        fit = partial(fit_on_ground, by_noise=by_noise, check=check)
    elif drives is not None and unknown_constants(drives):
        fit = search_constants
    elif any(term.loaded for term in problem.terms):
        fit = fit_under_load
    fitted = fit(problem, chosen)
    if delay is not None:
        shifted = without_delays(problem, fitted)
        if any(group.delays is not None for group in shifted.groups):
            fitted = fit(shifted, chosen)
    if check and not by_noise:
        fitted = with_noise_checked(fitted, chosen)
    source = "passed to identify" if preparation is None else "that of the preparation passed to identify"
    source = "chosen by the noise of the angles" if by_noise else source
    result = Result.of(fitted, chosen, source, white=noise == "white")
    doubt, found = rounding_errors(fitted, chosen, result.covariance) if check else (0.0, ())
    fitted = fitted._replace(findings=(*fitted.findings, *found))
    result = replace(result, fitted=fitted, covariance=result.covariance + doubt)
    if problem.groups[0].name == "":
        estimate = result.estimate(0, result.warnings)
        estimate = with_negative(result.checked(estimate, 0) if check else estimate)
        return share_alike(estimate, alike) if alike else estimate
    return result.grouped(check=check)
