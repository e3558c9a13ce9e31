"""Many virtual identifications of a built-in leg, for the studies beside this file.

The leg follows each motion exactly, so that all errors are due to noise. The seed of a replicate depends only on the
seed of the study and the number of the replicate, so that any number of processes gives the same bits.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

import numpy as np
import scipy
from joblib import Parallel, delayed
from threadpoolctl import threadpool_limits

import exoid
from exoid._typing import BoolArray, FloatArray
from exoid.experiments import Harmonics, bleex, cuhk
from exoid.experiments.excitation import Plan
from exoid.experiments.references import States
from exoid.leg import Leg
from exoid.tools.tables import make_table, to_text
from exoid.torques import Term, TorqueModel


@dataclass(frozen=True)
class Noise:
    """Stationary torque noise: the sum of autoregressive noise of first order and white noise."""

    name: str  # name in results
    std: tuple[float, ...]  # standard deviation at each joint [N·m]
    share: float = 0.0  # share of the variance that is correlated, 0 to 1
    memory: float = 0.05  # correlation time, in which the autocorrelation falls to 1/e [s]

    def draw(self, rng: np.random.Generator, samples: int, rate: float) -> FloatArray:
        """Draw noise [N·m], (N, n)."""
        phi, shape = self._phi(rate), (samples, len(self.std))
        white, innovations = rng.standard_normal(shape), rng.standard_normal(shape)
        innovations[1:] *= math.sqrt(1.0 - phi**2)  # stationary from the first sample on
        coloured = scipy.signal.lfilter([1.0], [1.0, -phi], innovations, axis=0)
        unit = math.sqrt(self.share) * coloured + math.sqrt(1.0 - self.share) * white
        return np.asarray(unit * np.array(self.std))

    def information(self, W: FloatArray, rate: float) -> FloatArray:
        """Compute the Fisher information Σ_j W_jᵀ Γ_j⁻¹ W_j of consecutive rows (N, n, P), (P, P)."""
        # Q is the tridiagonal inverse of the covariance of AR(1) noise of unit variance, s its share; then
        # Γ⁻¹ = (s Q⁻¹ + (1 − s) I)⁻¹ = (s I + (1 − s) Q)⁻¹ Q.
        phi, share = self._phi(rate), self.share
        diagonal = np.full(len(W), 1.0 + phi**2)
        diagonal[[0, -1]] = 1.0
        beside = -phi / (1.0 - phi**2)
        diagonal /= 1.0 - phi**2
        inner = np.vstack([np.full(len(W), (1.0 - share) * beside), (1.0 - share) * diagonal + share])
        information = np.zeros((W.shape[2],) * 2)
        for joint, std in enumerate(self.std):
            X = W[:, joint]
            QX = diagonal[:, None] * X
            QX[1:] += beside * X[:-1]
            QX[:-1] += beside * X[1:]
            information += X.T @ scipy.linalg.solveh_banded(inner, QX) / std**2
        return information

    def _phi(self, rate: float) -> float:
        return math.exp(-1.0 / (self.memory * rate))


class Protocol(NamedTuple):
    """Motions of one leg, one after the other."""

    name: str  # name in results
    motions: tuple[Harmonics, ...]  # motions of one rig each
    seconds: float  # duration of each motion [s]

    def states(self, motion: int, rate: float) -> States:
        """Sample a motion [rad, rad/s, rad/s²], (N, n) each."""
        return self.motions[motion].over(np.arange(round(self.seconds * rate) + 1) / rate)


def planned(plan: Plan) -> Protocol:
    """Make a protocol of the motions of a plan with an upright torso."""
    return Protocol("planned", tuple(motion.reference for motion in plan.motions), plan.motions[0].duration)


def document(leg: Leg, duration: float) -> Protocol:
    """Make a protocol of the dynamic experiments of a built-in leg's document, shortened to a duration [s].

    BLEEX: fifteen swings, each joint at five frequencies. CUHK-EXO: the random multisine of the replay, because the
    swings of Table II do not determine every parameter.
    """
    if len(leg.joint_labels) == 2:
        motions = (cuhk.multisine(leg, np.random.default_rng(0)),)
    else:
        every = bleex.dynamic_motions()
        motions = tuple(
            Harmonics(*(part[..., [rig]] for part in (every.centre, every.amplitude, every.frequency, every.phase)))
            for rig in range(bleex.VALIDATION)
        )
    return Protocol("document", motions, duration / len(motions))


def plausible_truth(model: TorqueModel, typical: FloatArray) -> tuple[float, ...]:
    """Choose parameters: the URDF's, and resistances of some percent of each joint's typical torque [N·m], (n,)."""
    share = {"c0": 0.03, "d": 0.01, "Ia": 0.01, "offset": 0.01}
    joints = dict(zip(model.leg.joint_labels, typical.tolist(), strict=True))
    known = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True))
    for name in model.names[len(known) :]:
        symbol, _, joint = name.partition("_")
        known[name] = share[symbol] * joints[joint]
    return tuple(float(known[name]) for name in model.names)


class Chunk(NamedTuple):
    """Some replicates of one protocol under one noise."""

    protocol: int  # index of the protocol
    noise: int  # index of the noise
    first: int  # number of the first replicate
    replicates: int  # number of replicates


@dataclass(frozen=True)
class Study:
    """Many virtual identifications; all estimators use the same data."""

    leg: str  # name of a built-in leg
    terms: tuple[Term, ...]  # terms of the true and of the identified model
    truth: tuple[float, ...]  # true parameters, in the order of the model's names
    protocols: tuple[Protocol, ...]  # motions of the identification
    noises: tuple[Noise, ...]  # torque noise
    estimators: tuple[str, ...] = ("wls",)  # names of estimators, as in exoid.identify
    replicates: int = 100  # number for each protocol and noise
    seed: int = 0  # seed of all random numbers
    rate: float = 100.0  # rate of the log [Hz]
    cutoff: float = 8.0  # cut-off frequency of the parallel filter [Hz]
    chunk: int = 20  # number of replicates of a chunk

    @property
    def model(self) -> TorqueModel:
        """Leg and terms."""
        return _model(self.leg, self.terms)

    @property
    def chunks(self) -> list[Chunk]:
        """All chunks, in the order of their numbers."""
        firsts = range(0, self.replicates, self.chunk)
        return [
            Chunk(protocol, noise, first, min(self.chunk, self.replicates - first))
            for protocol, noise, first in itertools.product(range(len(self.protocols)), range(len(self.noises)), firsts)
        ]

    def information(self, protocol: int, noise: int) -> FloatArray:
        """Compute the Fisher information of unfiltered rows, Σ_j W_jᵀ Γ_j⁻¹ W_j over joints and motions, (P, P)."""
        model, motions = self.model, self.protocols[protocol]
        rows = (model.regressor(*motions.states(k, self.rate)) for k in range(len(motions.motions)))
        return np.asarray(sum(self.noises[noise].information(W, self.rate) for W in rows))

    def bound(self, protocol: int, noise: int) -> FloatArray:
        """Compute the Cramér–Rao bound: the smallest standard deviations of unbiased estimates, (P,)."""
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(self.information(protocol, noise)))))


@cache
def _model(leg: str, terms: tuple[Term, ...]) -> TorqueModel:
    return TorqueModel(exoid.load_leg(leg), terms)


class Outcomes(NamedTuple):
    """Results of the replicates of a chunk; E estimators, R replicates, P parameters."""

    values: FloatArray  # estimates, (E, R, P)
    std: FloatArray  # standard deviations that the estimates state, (E, R, P)
    inside: BoolArray  # whether 95 % intervals contain the truth, (E, R, P)


def run_chunk(study: Study, number: int) -> Outcomes:
    """Record and identify the replicates of a chunk; the result is bit-identical in any process."""
    chunk, truth, model = study.chunks[number], np.array(study.truth), study.model
    shape = (len(study.estimators), chunk.replicates, len(truth))
    values, std, inside = np.empty(shape), np.empty(shape), np.empty(shape, dtype=np.bool_)
    with threadpool_limits(limits=1):
        for k, recordings in enumerate(_recorded(study, chunk)):
            for e, name in enumerate(study.estimators):
                estimate = exoid.identify(model.leg, recordings, study.terms, name, cutoff=study.cutoff, check=False)
                low, high = estimate.interval().T
                values[e, k], std[e, k] = estimate.values, estimate.std
                inside[e, k] = (low <= truth) & (truth <= high)
    return Outcomes(values, std, inside)


def _recorded(study: Study, chunk: Chunk) -> Iterator[list[exoid.Recording]]:
    """Recordings of each replicate."""
    noise, protocol = study.noises[chunk.noise], study.protocols[chunk.protocol]
    clean = [_exactly(study, protocol.states(k, study.rate)) for k in range(len(protocol.motions))]
    for replicate in range(chunk.replicates):
        rng = np.random.default_rng([study.seed, chunk.protocol, chunk.noise, chunk.first + replicate])
        yield [replace(log, tau=tau + noise.draw(rng, len(log), study.rate)) for log, tau in clean]


def _exactly(study: Study, states: States) -> tuple[exoid.Recording, FloatArray]:
    """Recording of a motion, and its torque without noise."""
    time = np.arange(len(states.q)) / study.rate
    tau = study.model.regressor(*states) @ np.array(study.truth)
    return exoid.Recording(time, *states, tau, joint_names=study.model.leg.joint_names), tau


@dataclass(frozen=True, eq=False)
class Combination:
    """Statistics of one protocol, noise and estimator."""

    protocol: str  # name of the protocol
    noise: str  # name of the noise
    estimator: str  # name of the estimator
    names: tuple[str, ...]  # names of the parameters, (P,)
    units: tuple[str, ...]  # units of the parameters, (P,)
    bias: FloatArray  # mean error, (P,)
    std: FloatArray  # standard deviation of the estimates, (P,)
    stated: FloatArray  # root mean square of the standard deviations that the estimates state, (P,)
    coverage: FloatArray  # share of 95 % intervals that contain the truth, (P,)
    bound: FloatArray  # smallest standard deviation of an unbiased estimate (Cramér–Rao), (P,)
    replicates: int  # number of identifications

    @property
    def efficiency(self) -> FloatArray:
        """Squared Cramér–Rao bound divided by the mean squared error, (P,); 1 is best."""
        return np.asarray(self.bound**2 / (self.std**2 + self.bias**2))

    def __str__(self) -> str:
        """Print as a table, one line for each parameter."""
        columns = (self.names, self.bias, self.std, self.stated, self.coverage, self.efficiency, self.units)
        table = make_table(
            ["parameter", "bias", "std", "stated", "coverage %", "efficiency", "unit"],
            [
                (name, f"{bias:+.2g}", f"{std:.3g}", f"{stated:.3g}", f"{100.0 * cover:.1f}", f"{part:.2f}", unit)
                for name, bias, std, stated, cover, part, unit in zip(*columns, strict=True)
            ],
        )
        return to_text(f"{self.protocol}, {self.noise} noise, {self.estimator}", table)


@dataclass(frozen=True, eq=False)
class StudyResult:
    """All combinations of a study; prints itself."""

    study: Study  # the study
    combinations: tuple[Combination, ...]  # statistics by protocol, noise and estimator

    def __str__(self) -> str:
        """Print as a table, one line for each combination: means over parameters, and the worst parameter."""
        rows = []
        for each in self.combinations:
            far, low = int(np.argmax(np.abs(each.coverage - 0.95))), int(np.argmin(each.efficiency))
            bias = np.abs(each.bias) / each.std
            rows.append(
                (
                    f"{each.protocol}, {each.noise}, {each.estimator}",
                    f"{100.0 * each.coverage.mean():.1f}",
                    f"{100.0 * each.coverage[far]:.1f} ({each.names[far]})",
                    f"{each.efficiency.mean():.2f}",
                    f"{each.efficiency[low]:.2f} ({each.names[low]})",
                    f"{bias.max():.2f} ({each.names[int(np.argmax(bias))]})",
                )
            )
        table = make_table(["combination", "coverage %", "farthest", "efficiency", "lowest", "bias / std"], rows)
        study = self.study
        error = 100.0 * math.sqrt(0.95 * 0.05 / study.replicates)
        head = f"{study.replicates} identifications of each, seed {study.seed}"
        closing = (
            f"Coverage of 95 % intervals: mean over parameters and farthest from 95; Monte-Carlo error ± {error:.1f} "
            f"of each parameter, ± {1.0 / math.sqrt(study.replicates):.2f} of bias / std."
        )
        return to_text(head, table, closing)


def run_study(study: Study, workers: int = 1) -> StudyResult:
    """Run the chunks of a study in some processes, and combine them in the order of their numbers."""
    numbers = range(len(study.chunks))
    outcomes = Parallel(n_jobs=workers, batch_size=1)(delayed(run_chunk)(study, number) for number in numbers)
    with threadpool_limits(limits=1):  # as for the chunks
        return StudyResult(study, tuple(_combinations(study, outcomes)))


def _combinations(study: Study, outcomes: list[Outcomes]) -> Iterator[Combination]:
    """Statistics of each protocol, noise and estimator, all chunks combined."""
    for p, n in itertools.product(range(len(study.protocols)), range(len(study.noises))):
        own = [of for of, chunk in zip(outcomes, study.chunks, strict=True) if (chunk.protocol, chunk.noise) == (p, n)]
        values, std, inside = (np.concatenate(parts, axis=1) for parts in zip(*own, strict=True))
        bound, truth = study.bound(p, n), np.array(study.truth)
        for e, name in enumerate(study.estimators):
            errors = values[e] - truth
            yield Combination(
                protocol=study.protocols[p].name,
                noise=study.noises[n].name,
                estimator=name,
                names=study.model.names,
                units=study.model.units,
                bias=errors.mean(axis=0),
                std=errors.std(axis=0, ddof=1),
                stated=np.sqrt((std[e] ** 2).mean(axis=0)),
                coverage=inside[e].mean(axis=0),
                bound=bound,
                replicates=len(errors),
            )
