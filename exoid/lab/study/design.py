"""Design of a study: what it varies, and how it is divided into chunks."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.identification.estimators.by_name import ESTIMATORS
from exoid.leg.description import describe
from exoid.leg.leg import Leg
from exoid.tools.numbers import checked
from exoid.torques import Term, TorqueModel

from .noise import Noise
from .protocol import Protocol


class LegText(NamedTuple):
    """A leg as text, which can be sent to workers.

    Attributes:
        urdf: Text of the URDF.
        name: Name of the file.
        joints: Joints that move.
        locked: Positions of other joints, by name.
        cumulative: See :class:`exoid.Leg`.
    """

    urdf: str
    name: str
    joints: tuple[str, ...]
    locked: tuple[tuple[str, float], ...]
    cumulative: bool

    @classmethod
    def of(cls, leg: Leg) -> LegText:
        """Describe a leg.

        Args:
            leg: The leg.

        Returns:
            Its description.

        Raises:
            ExoidError: The base of the leg moves, or the leg has closed loops.
        """
        about = leg.description
        if leg.closure is not None:  # the text of a URDF is a tree, and would be studied as one
            raise NotSupportedError(
                "studies simulate trees, and the leg has closed loops",
                where=about.name,
                remedy="simulate it in MuJoCo, and identify its logs one by one",
            )
        if leg.base != "fixed":
            raise NotSupportedError(
                "studies simulate legs on a fixed base", where=about.name, remedy='use base="fixed"'
            )
        return cls(about.text, about.name, leg.joint_names, tuple(leg.locked.items()), leg.cumulative)


class Chunk(NamedTuple):
    """Some replicates of one protocol under one noise."""

    protocol: int  # index of the protocol
    noise: int  # index of the noise
    first: int  # number of the first replicate
    replicates: int  # number of replicates


@dataclass(frozen=True)
class Study:
    """Many virtual identifications.

    The leg follows each motion exactly, so that all errors are due to noise. Every replicate has different noise. Its
    seed depends only on the seed of the study and the number of the replicate.
    All estimators use the same data.

    Attributes:
        leg: The leg.
        terms: Terms of the true and of the identified model.
        truth: True parameters in SI units, in the order of the model's names.
        protocols: Motions of the identification.
        noises: Torque noise.
        estimators: Names of estimators, as in :func:`exoid.identify`.
        replicates: Number of replicates of each protocol and noise.
        seed: Seed of all random numbers.
        rate: Rate of the log [Hz].
        cutoff: Cut-off frequency of the parallel filter [Hz].
        chunk: Number of replicates of a chunk.
    """

    leg: LegText
    terms: tuple[Term, ...]
    truth: tuple[float, ...]
    protocols: tuple[Protocol, ...]
    noises: tuple[Noise, ...]
    estimators: tuple[str, ...] = ("wls",)
    replicates: int = 100
    seed: int = 0
    rate: float = 100.0
    cutoff: float = 8.0
    chunk: int = 20

    def __post_init__(self) -> None:
        """Check the settings before anything runs."""
        checked(self.replicates, "replicates", least=2, most=1e7)
        checked(self.chunk, "replicates of a chunk", least=1)
        checked(self.seed, "seed", least=0)
        unknown = [name for name in self.estimators if name not in ESTIMATORS]
        if unknown or not self.estimators or len(set(self.estimators)) < len(self.estimators):
            remedy = f"name each once, out of {', '.join(ESTIMATORS)}"
            raise BadArgumentError(f"estimators {', '.join(self.estimators) or 'none'}", remedy=remedy)
        names, joints = self.model.names, len(self.leg.joints)
        if not self.protocols or not self.noises or {len(noise.std) for noise in self.noises} != {joints}:
            sizes = ", ".join(str(len(noise.std)) for noise in self.noises) or "no"
            what = f"{len(self.protocols)} protocols, and noise of {sizes} joints for a leg of {joints}"
            raise BadArgumentError(what, remedy="give at least one protocol, and one noise for each joint")
        if len(self.truth) != len(names):
            remedy = f"give one value for each of {', '.join(names)}"
            raise BadArgumentError(f"{len(self.truth)} true parameters", remedy=remedy)

    @property
    def model(self) -> TorqueModel:
        """Leg and terms."""
        return _model(self.leg, self.terms)

    @cached_property
    def chunks(self) -> tuple[Chunk, ...]:
        """All chunks, in the order of their numbers."""
        firsts = range(0, self.replicates, self.chunk)
        return tuple(
            Chunk(protocol, noise, first, min(self.chunk, self.replicates - first))
            for protocol, noise, first in itertools.product(range(len(self.protocols)), range(len(self.noises)), firsts)
        )

    def information(self, protocol: int, noise: int) -> FloatArray:
        """Compute the Fisher information of unfiltered rows, Σ_j W_jᵀ Γ_j⁻¹ W_j over joints and motions.

        Args:
            protocol: Index of the protocol.
            noise: Index of the noise.

        Returns:
            Information matrix in inverse squared units of the parameters, (P, P).
        """
        model, motions = self.model, self.protocols[protocol]
        rows = (model.regressor(*motions.states(k, self.rate)) for k in range(len(motions.motions)))
        return np.asarray(sum(self.noises[noise].information(W, self.rate) for W in rows))

    def bound(self, protocol: int, noise: int) -> FloatArray:
        """Compute the Cramér–Rao bound of unbiased estimates from unfiltered rows.

        Args:
            protocol: Index of the protocol.
            noise: Index of the noise.

        Returns:
            Smallest standard deviations, in units of the parameters, (P,).
        """
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(self.information(protocol, noise)))))


@cache
def _model(leg: LegText, terms: tuple[Term, ...]) -> TorqueModel:
    return TorqueModel(
        Leg.from_description(
            describe(leg.urdf, leg.name), leg.joints, locked=dict(leg.locked), cumulative=leg.cumulative
        ),
        terms,
    )


def plausible_truth(model: TorqueModel, typical: FloatArray) -> tuple[float, ...]:
    """Choose parameters of virtual legs: the URDF's, and resistances of some percent of each joint's typical torque.

    Args:
        model: Leg and terms.
        typical: Typical torque of each joint [N·m], (n,).

    Returns:
        Parameters in SI units, in the order of ``model.names``, P of them.
    """
    share = {"c0": 0.03, "d": 0.01, "Ia": 0.01, "offset": 0.01}
    joints = dict(zip(model.leg.joint_labels, typical.tolist(), strict=True))
    known = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True))
    for name in model.names[len(known) :]:
        symbol, _, joint = name.partition("_")
        known[name] = share.get(symbol, 0.0) * joints.get(joint, 0.0)  # a coupling has no joint of its own
    return tuple(float(known[name]) for name in model.names)
