"""Values of identified parameters, their uncertainty, and the evidence for both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload
from exoid.leg.torso import MovingBase
from exoid.regression.diagnostics import JointNoise
from exoid.regression.intervals import half_width
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from exoid.signals import Preparation
from exoid.torques import Regrouped, TorqueModel
from exoid.torques.catalog import radians
from exoid.torques.motion import BLOCK

from .evidence import Evidence, Support, freeze
from .finding import Finding
from .model_error import AlternativeFriction, ModelError, TorqueBand, parameter_variance
from .nonlinear import NO_NONLINEAR_PARAMETERS, NonlinearParameters
from .parameter import Parameter, ParameterTable


@dataclass(frozen=True)
class Input:
    """One recording that went into an estimate."""

    name: str  # file name, or "array" for one made in memory
    sha256: str  # hash of the file, or of the arrays
    samples: int  # number of samples
    sample_rate: float  # [Hz]
    segments: tuple[tuple[float, float], ...] = ()  # time stamps of the segments that were used [s]; empty for all
    payloads: tuple[str, ...] = ()  # payloads on the leg, as text; empty for none
    moving_base: bool = False  # whether the base moved
    wrenches: tuple[str, ...] = ()  # links on which wrenches were measured
    passive: tuple[str, ...] = ()  # joints without an actuator

    @property
    def label(self) -> str:
        """Name, with the payloads if there were any."""
        return f"{self.name} with {' and '.join(self.payloads)}" if self.payloads else self.name


@dataclass(frozen=True, eq=False, repr=False)
class EstimateData(ParameterTable):
    """Identified parameters of a leg with their covariance.

    Attributes:
        model: Leg as it was given, and the terms beside it, loaded by the values: what the parameters belong to.
        values: Parameters in the order of :attr:`names`, (P,).
        covariance: Covariance of the values, (P, P).
        condition_number: Condition number of the regressor with columns scaled to unit length; below 100 is good.
        dof: Independent samples less parameters.
        residual_rms: RMS residual of each joint on the data that were fitted, behind its cut-off [N·m], (n,).
        estimator: Name of the estimator.
        preparation: Filter and differentiation of the recordings.
        inputs: Recordings that were fitted.
        warnings: Reasons to doubt this estimate.
        prior_knowledge: Known parameters, priors and signs.
        nonlinear: Constants of drives that were fitted, such as a torque constant; the covariance of the values
            includes their uncertainty.
        findings: Faults of the logs or the model that checks found, the worst first; see ``docs/checks.md``.
        model_error: Doubt about the form of friction, which widens bands beyond the motion that was fitted; None where
            it was not stored, or where logs were not checked.
        torque_delays: Delays that were taken out of the torques [s], (n,); validation takes them out too.
        actuators: Drives of the recordings, which validation uses too; None where torques were measured.
        evidence: What recordings say beside the values: noise, scales.
        columns: How the command line read its logs, as in a file for ``--columns``; empty if as they stand.
    """

    model: TorqueModel
    values: FloatArray
    covariance: FloatArray
    condition_number: float
    dof: float
    residual_rms: FloatArray
    estimator: str
    preparation: Preparation
    inputs: tuple[Input, ...] = ()
    warnings: tuple[str, ...] = ()
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE
    nonlinear: NonlinearParameters = NO_NONLINEAR_PARAMETERS
    findings: tuple[Finding, ...] = ()
    model_error: ModelError | None = None
    torque_delays: FloatArray = None  # type: ignore[assignment]  # None only until it is zero here
    actuators: Actuators | None = None
    evidence: Evidence = field(default_factory=Evidence)
    columns: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check sizes and forbid changes."""
        count, joints = len(self.names), len(self.joint_names)
        if self.torque_delays is None:
            object.__setattr__(self, "torque_delays", np.zeros(joints))
        freeze(self, {"values": (count,), "covariance": (count, count)})
        freeze(self, {"residual_rms": (joints,), "torque_delays": (joints,)})
        self.evidence.check(count, joints)
        object.__setattr__(self, "model", self.model.loaded_by(self.values))
        object.__setattr__(self, "nonlinear", replace(self.nonlinear, doubtful=self.doubtful))
        positive = min(self.dof, *self.dof_each) > 0.0 and (np.diag(self.covariance) >= 0.0).all()
        if not (positive and self.condition_number >= 1.0):
            raise BadArgumentError(
                "degrees of freedom, condition number or a variance is not what a least-squares fit gives",
                remedy="identify again",
            )

    @property
    def noise(self) -> tuple[JointNoise, ...]:
        """Noise of the residuals of each joint; see :class:`Evidence`."""
        return self.evidence.noise or ()

    @property
    def supports(self) -> tuple[Support, ...]:
        """Sets of links that rested on the ground; empty without contacts."""
        return self.evidence.supports

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters: the leg's, then those of the terms, joint by joint."""
        return self.model.names

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return self.model.units

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joints of the leg."""
        return self.model.leg.joint_names

    @property
    def passive(self) -> tuple[str, ...]:
        """Joints that have no actuator by any of the recordings; control laws give them no torque."""
        return tuple(name for name in self.joint_names if any(name in one.passive for one in self.inputs))

    @property
    def trained(self) -> tuple[bool, ...]:
        """Whether the torque of each joint was among those that the estimate was fitted to, (n,)."""
        return tuple(noise.samples > 0 for noise in self.noise) or (True,) * len(self.joint_names)

    @property
    def nrmse(self) -> FloatArray:
        """RMS residual of each joint over the standard deviation of its torque, (n,); not a number where unknown."""
        spread = np.zeros(len(self.residual_rms)) if (known := self.evidence.torque_spread) is None else known
        return np.asarray(np.divide(self.residual_rms, spread, out=np.full(len(spread), np.nan), where=spread > 0.0))

    @property
    def r2(self) -> FloatArray:
        """Coefficient of determination of the fit of each joint, 1 − NRMSE², (n,); not a number where unknown."""
        return 1.0 - self.nrmse**2

    @property
    def regrouped(self) -> tuple[Regrouped, ...]:
        """Parameters that are part of others, as no motion tells them apart."""
        return self.model.regrouped

    @property
    def doubtful(self) -> frozenset[str]:
        """Parameters that a finding makes doubtful."""
        return frozenset(name for one in self.findings if one.severity != "info" for name in one.parameters)

    def __getitem__(self, name: str) -> Parameter:
        """Look up one parameter by name, a nonlinear one too.

        Args:
            name: Name of the parameter, such as "X1".

        Returns:
            Value, standard deviation, 95 % interval, unit and identifiability.

        Raises:
            ExoidError: There is no such parameter.
        """
        if name not in self.nonlinear.names:
            return self.parameter(name)
        nonlinear = self.nonlinear
        k = nonlinear.names.index(name)
        value, std, (low, high) = float(nonlinear.values[k]), float(nonlinear.std[k]), nonlinear.interval(self.dof)[k]
        return Parameter(name, value, std, (float(low), float(high)), nonlinear.units[k], nonlinear.identifiability[k])

    def __iter__(self) -> Iterator[str]:
        """Go over the names of all parameters."""
        return iter((*self.names, *self.nonlinear.names))

    def value(self, name: str) -> float:
        """Look up the value of one parameter: short for ``estimate[name].value``.

        Args:
            name: Name of the parameter.

        Returns:
            Its value.

        Raises:
            ExoidError: There is no such parameter.
        """
        return self[name].value

    @cached_property
    def leg(self) -> Leg:
        """The leg with the identified rigid-body parameters."""
        return self.model.leg.with_parameters(self.values[: len(self.model.leg.parameter_names)])

    def torque(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        torso: MovingBase | None = None,
        payloads: Sequence[Payload] = (),
    ) -> FloatArray:
        """Predict actuator torques τ = W(q, v, a) β, rigid bodies and terms together.

        Friction that depends on load takes the estimate's own rigid-body torque. Terms with presliding take the samples
        in time order and start as if the joint had slid in the direction of its first velocity, or undeflected if it is
        at rest.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.
            payloads: Payloads on the leg; their torque is added.

        Returns:
            Torques [N·m], (N, n).
        """
        motion = self.model.motion(q, v, a, torso, payloads)
        torque = self.model.columns(motion).transpose(2, 1, 0) @ self.values
        return torque if motion.payload is None else torque + motion.payload

    @cached_property
    def band_model(self) -> TorqueModel:
        """Torque model with the columns that the band of a measured torque needs: friction of other forms."""
        if self.model_error is None:
            return self.model
        rigid = self.values[: len(self.model.leg.parameter_names)]
        extras = (AlternativeFriction(rigid, self.model_error.speed, radians(self.model.leg)),)
        return replace(self.model, extras=extras)

    @property
    def residual_variance(self) -> FloatArray:
        """Variance of each joint's torque about the model [N²·m²], (n,): residuals are smaller, as they were fitted."""
        return (self.dof + len(self.values)) / self.dof * self.residual_rms**2

    @property
    def noise_variance(self) -> FloatArray:
        """Variance of the noise of each joint's torque behind the filter of the training [N²·m²], (n,)."""
        residual = self.residual_variance
        if self.model_error is None:
            return residual
        # At least a quarter of the residual variance is noise, whatever friction of other forms explains
        return np.maximum(residual - self.model_error.explained, 0.25 * residual)

    def measured_variance(self, rows: FloatArray, bandwidth: float = 1.0) -> FloatArray:
        """Variance of a measured torque about the predicted one: parameters, noise and model error.

        Args:
            rows: Rows of :attr:`band_model`, filtered like the torque, (N, n, P or more).
            bandwidth: Noise bandwidth of that filter over that of the training's; noise counts as white.

        Returns:
            Variance [N²·m²], (N, n).

        Raises:
            ExoidError: The base of the leg floats: forces on it were not measured as torques are.
        """
        if self.model.leg.base_rows:
            raise NotSupportedError(
                "the rows of a floating base have no measured torque",
                remedy="use exoid.ground_forces and exoid.validate, which have bands",
            )
        variance = parameter_variance(self.covariance, rows) + bandwidth * self.noise_variance
        return variance if self.model_error is None else variance + self.model_error.variance(rows)

    def torque_band(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        torso: MovingBase | None = None,
        *,
        level: float = 0.95,
        measured: bool = True,
    ) -> TorqueBand:
        """Band that contains a new torque of each sample with so much probability, by Student's t.

        A measured torque includes the model error: friction may have another form than the terms, as far as the
        residuals allow. Inside the motion of the training that is part of the residuals. Beyond it, it grows. A
        measured torque takes the degrees of freedom of the noise, the model's own the fewest of any parameter. Loads of
        friction count as exact.

        Args:
            q: Joint angles [rad], (N, n), in time order if ``measured``.
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.
            level: The probability, between 0 and 1.
            measured: True for a torque measured and filtered like those that the estimate was made from, False for the
                model's own, without noise.

        Returns:
            Torque with the lower and upper edge of its band [N·m], (N, n) each.
        """
        model = self.band_model
        spread = self.measured_variance if measured else partial(parameter_variance, self.covariance)
        motion = model.motion(q, v, a, torso)
        variance = np.empty((len(motion.q), len(self.model.row_names)))
        for start in range(0, len(variance), BLOCK):
            rows = slice(start, start + BLOCK)
            variance[rows] = spread(model.columns(motion.rows(rows)).transpose(2, 1, 0))
        half = half_width(level, self.dof if measured else float(self.dof_each.min())) * np.sqrt(variance)
        torque = self.torque(q, v, a, torso)
        return TorqueBand(torque, torque - half, torque + half)
