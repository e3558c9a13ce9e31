"""Where the numbers in a C file come from, as the comment at its top."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .dialect import Dialect, comment

if TYPE_CHECKING:
    from exoid.estimate import Estimate


def provenance(estimate: Estimate, prefix: str, dialect: Dialect) -> str:
    """Say what was identified from what, and how to read the numbers."""
    lines = [
        f"{estimate.model.leg.description.name}: dynamics of an identified planar leg, {dialect.real} precision.",
        f"Written by exoid {_version()}; do not edit, identify again instead.",
        "",
        *_conventions(estimate),
        "",
        *_use(prefix),
        "",
        *_sources(estimate),
        "",
        "Parameters, with their standard deviations:",
        *_parameters(estimate),
    ]
    return "\n".join(["/*", *(f" * {comment(line)}".rstrip() for line in lines), " */"])


def _version() -> str:
    from exoid import __version__  # noqa: PLC0415 - the package imports this one

    return __version__


def _conventions(estimate: Estimate) -> list[str]:
    inertia = "contains" if estimate.model.leg.cumulative else "does not contain"
    return [
        f"Joints, in the order of every array: {', '.join(estimate.joint_names)}.",
        "SI units: rad, rad/s, rad/s^2, N m. Angles are those of the URDF, zero pose and positive directions included.",
        "tau is the torque of the actuators: tau = M(q) a + C(q, v) v + G(q) + friction + springs + offsets, so that",
        f"dissipative friction has positive parameters. J of a segment {inertia} the J below it. The torso is upright.",
    ]


def _use(prefix: str) -> list[str]:
    return [
        "Compile this file as C99 and link the mathematical library (-lm). To call it from another file, define",
        f"{prefix.upper()}_DECLARATIONS_ONLY there and include this one. The functions keep no state: interrupts and",
        "threads may share them. Outputs must not overlap inputs.",
    ]


def _sources(estimate: Estimate) -> list[str]:
    description = estimate.model.leg.description
    lines = [
        f"URDF: {description.name}",
        f"  sha256 {description.sha256}",
        f"Estimator: {estimate.estimator}, {estimate.preparation.name} preparation; condition number "
        f"{estimate.condition_number:.1f}.",
    ]
    for source in estimate.inputs:
        lines.append(f"Data: {source.name}, {source.samples} samples at {source.sample_rate:g} Hz")
        lines.append(f"  sha256 {source.sha256}")
    lines += [f"Warning: {warning}" for warning in estimate.warnings]
    return [*lines, *(f"Note: {regrouped}." for regrouped in estimate.regrouped)]


def _parameters(estimate: Estimate) -> list[str]:
    rows = zip(estimate.names, estimate.values, estimate.std, estimate.units, estimate.identifiability, strict=True)
    return [
        f"  {name} = {value:.6g} +- {std:.2g} {unit}, {judged} determined" for name, value, std, unit, judged in rows
    ]
