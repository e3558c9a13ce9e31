"""What is tried by default when terms and settings are to be selected."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from exoid.signals import Preparation, Smoothed, ZeroPhase
from exoid.torques import Armature, Coulomb, LoadFriction, NonlinearParameter, Offset, Stribeck, Term, Viscous

BENDING = NonlinearParameter(start=1e-3, lower=1e-5, upper=0.03)
"""Presliding [rad]: from well below an encoder's step to two degrees."""

FADING = NonlinearParameter(start=0.1, lower=0.01, upper=0.5)
"""Stribeck velocity [rad/s]; beyond, it is no longer a matter of slow motion and mimics viscous friction."""


@dataclass(frozen=True)
class Candidate:
    """One way to identify a leg.

    Attributes:
        name: Short name for tables.
        terms: Terms of the torque model.
        estimator: Name of the estimator.
        preparation: From recordings to rows.
        zero: Names of coefficients of the terms that are held at zero.
    """

    name: str
    terms: tuple[Term, ...]
    estimator: str = "wls"
    preparation: Preparation = field(default_factory=ZeroPhase)
    zero: tuple[str, ...] = ()


def friction_candidates(cutoff: float = 8.0) -> tuple[Candidate, ...]:
    """Friction models from plain to rich, all with rotor inertia and offset, by weighted least squares.

    Args:
        cutoff: Cut-off frequency of the parallel filter [Hz].

    Returns:
        The candidates.
    """
    d = BENDING
    sharp, load, split = Coulomb(), LoadFriction(), LoadFriction(split=True)
    bent, bent_load, bent_split = (replace(term, presliding=d) for term in (sharp, load, split))
    fading = Stribeck(velocity=FADING)
    bent_fading = replace(fading, presliding=d)
    friction: dict[str, tuple[Term, ...]] = {
        "coulomb": (sharp,),
        "asymmetric": (Coulomb(asymmetric=True),),
        "stribeck": (sharp, fading),
        "load": (sharp, load),
        "load+split": (sharp, split),
        "presliding": (bent,),
        "presliding+stribeck": (bent, bent_fading),
        "presliding+load": (bent, bent_load),
        "presliding+load+split": (bent, bent_split),
        "presliding+load+stribeck": (bent, bent_load, bent_fading),
        "presliding+load+split+stribeck": (bent, bent_split, bent_fading),
    }
    sensor = {name: () if name == "asymmetric" else (Offset(),) for name in friction}
    return tuple(
        Candidate(name, (*terms, Viscous(), Armature(), *sensor[name]), preparation=ZeroPhase(cutoff))
        for name, terms in friction.items()
    )


def filter_candidates(chosen: Candidate, cutoff: float = 8.0) -> tuple[Candidate, ...]:
    """Other filters for terms that are chosen already: lower, higher, and none for columns and torques.

    Args:
        chosen: With the terms, behind a parallel filter at ``cutoff``.
        cutoff: Cut-off frequency of that filter [Hz].

    Returns:
        The candidates.
    """
    return (
        *(
            replace(chosen, name=f"{chosen.name}, {factor * cutoff:g} Hz", preparation=ZeroPhase(factor * cutoff))
            for factor in (0.6, 1.5)
        ),
        replace(chosen, name=f"{chosen.name}, no parallel filter", preparation=Smoothed(2.0 * cutoff)),
    )


def estimator_candidates(chosen: Candidate) -> tuple[Candidate, ...]:
    """Other estimators for terms and a filter that are chosen already."""
    return (replace(chosen, name=f"{chosen.name}, huber", estimator="huber"),)
