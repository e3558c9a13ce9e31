"""What a study varies, and the chunks it falls into."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.description import describe
from exoid.errors import ExoidError
from exoid.identification.estimators import ESTIMATORS
from exoid.json_values import attributes, json_value, named
from exoid.leg import Leg
from exoid.torques import Term, TorqueModel, term_to_json
from exoid.torso import TorsoMotion

from .noise import Noise
from .protocol import Protocol
from .tracking_task import TrackingTask

SCHEMA = "exoid-study-1"

FOLLOWED = ("exactly", "by a rig")

BLIND = "pd"
"""A law that knows nothing of the leg."""

TRUTH = "truth"
"""What a law is told to compare with."""


class LegText(NamedTuple):
    """A leg as it travels to workers.

    Attributes:
        urdf: Text of the URDF.
        name: Of the file.
        joints: That move.
        locked: Positions of others, by name.
        cumulative: See :class:`exoid.Leg`.
    """

    urdf: str
    name: str
    joints: tuple[str, ...]
    locked: tuple[tuple[str, float], ...]
    cumulative: bool

    @classmethod
    def of(cls, leg: Leg) -> LegText:
        """Write a leg down."""
        about = leg.description
        return cls(about.text, about.name, leg.joint_names, tuple(leg.locked.items()), leg.cumulative)


class Driver(NamedTuple):
    """A law, and whose parameters it knows.

    Attributes:
        law: Name.
        knows: An estimator, "truth", or "nothing", as PD does.
    """

    law: str
    knows: str


class Chunk(NamedTuple):
    """Some replicates of one protocol under one noise.

    Attributes:
        protocol: Index.
        noise: Index.
        first: Number of the first replicate.
        replicates: How many.
    """

    protocol: int
    noise: int
    first: int
    replicates: int


@dataclass(frozen=True)
class Study:
    """Virtual identifications in great number.

    Every replicate draws noise of its own, from a seed that depends on nothing but the study's seed and its number; all
    estimators see the same data.

    Attributes:
        leg: The leg.
        terms: In the truth and in what is identified.
        truth: Parameters of the virtual legs, in the order of the model's names.
        protocols: What they do.
        noises: Of the torques.
        estimators: Names, as in :func:`exoid.identify`.
        replicates: Of each protocol and noise.
        seed: Of everything.
        rate: Of the log [Hz].
        cutoff: Of the parallel filter [Hz].
        followed: "exactly" (angles, velocities and accelerations as commanded: what remains is noise), or "by a rig"
            (simulated with servo, stiction and encoder: what the model leaves out shows as bias).
        chunk: Replicates that are done at once; a rig's are simulated side by side.
        course: What laws that know the estimates follow on the same leg; None for nothing.
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
    followed: str = "exactly"
    chunk: int = 20
    course: TrackingTask | None = None

    def __post_init__(self) -> None:
        """Check what can be checked before anything runs."""
        unknown = [name for name in self.estimators if name not in ESTIMATORS]
        if unknown or not self.estimators:
            raise ExoidError(
                f"no estimator {', '.join(unknown) or 'at all'}", remedy=f"use some of {', '.join(ESTIMATORS)}"
            )
        if len(set(self.estimators)) < len(self.estimators):
            raise ExoidError(f"estimators {', '.join(self.estimators)}", remedy="name each once")
        if self.followed not in FOLLOWED:
            raise ExoidError(f"motions followed {self.followed!r}", remedy=f"use one of {', '.join(FOLLOWED)}")
        if self.replicates < 2 or self.chunk < 1 or self.seed < 0 or not self.protocols or not self.noises:
            raise ExoidError(
                f"{self.replicates} replicates in chunks of {self.chunk}, seed {self.seed}, "
                f"{len(self.protocols)} protocols, {len(self.noises)} noises",
                remedy="at least two replicates, one in a chunk, one protocol and one noise; no negative seed",
            )
        names, joints = self.model.names, len(self.leg.joints)
        if len(self.truth) != len(names) or any(len(noise.std) != joints for noise in self.noises):
            raise ExoidError(
                f"{len(self.truth)} true parameters and noise of {', '.join(str(len(n.std)) for n in self.noises)} "
                f"joints for a leg of {joints}",
                remedy=f"give one value for each of {', '.join(names)} and noise for each joint",
            )
        if self.course is not None:
            self.course.refuse(self.model, np.array(self.truth))

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

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        """Who drives the leg along the course: each law, told the truth and told by each estimator."""
        laws = () if self.course is None else self.course.laws
        knows = {law: ("nothing",) if law == BLIND else (TRUTH, *self.estimators) for law in laws}
        return tuple(Driver(law, who) for law in laws for who in knows[law])

    def generator(self, chunk: Chunk, replicate: int) -> np.random.Generator:
        """Random numbers of one replicate, whoever draws them."""
        return np.random.default_rng([self.seed, chunk.protocol, chunk.noise, replicate])

    def torso(self, protocol: Protocol, motion: int) -> TorsoMotion | None:
        """How the torso is held during a motion."""
        pitch = protocol.pitches[motion]
        return TorsoMotion(pitch=pitch) if pitch else None

    def information(self, protocol: int, noise: int) -> FloatArray:
        """Fisher information of unfiltered rows, Σ_j W_jᵀ Γ_j⁻¹ W_j over joints and motions, (P, P)."""
        model, motions = self.model, self.protocols[protocol]
        rows = (
            model.regressor(*motions.states(k, self.rate), self.torso(motions, k)) for k in range(len(motions.motions))
        )
        return np.asarray(sum(self.noises[noise].information(W, self.rate) for W in rows))

    def bound(self, protocol: int, noise: int) -> FloatArray:
        """Smallest standard deviations that an unbiased estimate from unfiltered rows can have (Cramér–Rao), (P,)."""
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(self.information(protocol, noise)))))

    def to_json(self) -> dict[str, Any]:
        """Describe it completely: equal descriptions have equal results."""
        return {
            "schema": SCHEMA,
            "leg": {**json_value(self.leg), "locked": dict(self.leg.locked)},
            "terms": [term_to_json(term) for term in self.terms],
            "truth": named(self.model.names, self.truth),
            "protocols": [protocol.to_json() for protocol in self.protocols],
            **attributes(self, "noises", "estimators", "replicates", "seed", "rate", "cutoff", "followed"),
            "piece": self.chunk,
            **({} if self.course is None else {"course": self.course.to_json()}),
        }

    @property
    def sha256(self) -> str:
        """Hash of the description."""
        return hashlib.sha256(json.dumps(self.to_json(), sort_keys=True).encode()).hexdigest()


@cache
def _model(leg: LegText, terms: tuple[Term, ...]) -> TorqueModel:
    return TorqueModel(
        Leg.from_description(
            describe(leg.urdf, leg.name), leg.joints, locked=dict(leg.locked), cumulative=leg.cumulative
        ),
        terms,
    )


def plausible_truth(
    model: TorqueModel, typical: FloatArray, values: Mapping[str, float] | None = None
) -> tuple[float, ...]:
    """Parameters of virtual legs: the URDF's, and resistances of some percent of the typical torque of each joint.

    Args:
        model: Leg and terms.
        typical: Torque of each joint [N·m], (n,).
        values: Others, by name.
    """
    share = {"c0": 0.03, "d": 0.01, "Ia": 0.01, "offset": 0.01}
    joints = dict(zip(model.leg.joint_labels, typical.tolist(), strict=True))
    known = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True))
    for name in model.names[len(known) :]:
        symbol, _, joint = name.partition("_")
        known[name] = share.get(symbol, 0.0) * joints[joint]
    return (
        tuple(known[name] for name in model.names)
        if not values
        else tuple(float(values.get(name, known[name])) for name in model.names)
    )
