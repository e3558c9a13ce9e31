"""Control laws of ``exoid export --law``: from options to a law, and to its C."""

from __future__ import annotations

import numpy as np

from exoid import control, experiments
from exoid.codegen import CSource, Safety, write_c, write_ros2
from exoid.control import ControlModel
from exoid.control.observers import TorqueObserver
from exoid.control.stateful import AnyLaw
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.provenance import provenance

from .law_options import LawOptions
from .numbers import joint_values
from .refusals import refuse
from .track import SCALE, roles_of

PERIOD = 10.0
"""Period of the gait [s]."""

AMPLIFICATION = 2.0
"""Amplification: the wearer feels half of the inertia."""

WORN = ("gravity_support", "sensitivity_amplification", "impedance")
"""Names of the laws for a leg with a wearer."""

OBSERVERS: dict[str, type[TorqueObserver]] = {
    "momentum_observer": control.MomentumObserver,
    "kalman_observer": control.KalmanObserver,
}
"""Observers, which give the torque of the wearer in place of a command."""

OBSERVED = 8.0
"""Bandwidth of the observer [Hz]."""


def export_law(
    estimate: Estimate, name: str, path: str | None, options: LawOptions, precision: str, folder: str | None = None
) -> CSource:
    """Write a law for an estimate as C, or as a package for ROS 2."""
    # Gains, rate and gait are those of `exoid track` unless options say otherwise; the limit is that of the URDF.
    default = Safety()
    safety = Safety(
        options.safe or default.safe, patience=default.patience if options.patience is None else options.patience
    )
    _refuse_foreign(name, options)
    law = (
        _observer(estimate, name, options)
        if name in OBSERVERS
        else _limited(_law(estimate, name, options), estimate, options)
    )
    origin, warnings = provenance(estimate), estimate.warnings
    if folder is not None:
        return write_ros2(folder, law, precision=precision, safety=safety, provenance=origin, warnings=warnings)
    return write_c(str(path), law, precision=precision, safety=safety, provenance=origin, warnings=warnings)


def _law(estimate: Estimate, name: str, options: LawOptions) -> AnyLaw:
    model = ControlModel.of(estimate)
    labels = model.leg.joint_labels
    if name == "gravity_support":
        share = 1.0 if options.share is None else joint_values(options.share, "--share", labels, one_for_all=True)
        return control.gravity_support(model, share, rate=_rate(options, 100.0))
    if name == "sensitivity_amplification":
        amplification = np.full(len(labels), AMPLIFICATION)
        if options.amplification is not None:
            amplification = joint_values(options.amplification, "--amplification", labels, one_for_all=True)
        bandwidth = 20.0 if options.bandwidth is None else options.bandwidth
        return control.sensitivity_amplification(model, amplification, bandwidth=bandwidth, rate=_rate(options, 500.0))
    if name not in (*control.LAWS, *WORN):
        raise ExoidError(f"no controller {name}", remedy=f"use one of {', '.join((*control.LAWS, *WORN, *OBSERVERS))}")
    return _with_gains(estimate if name == "adaptive" else model, name, options)


def _observer(estimate: Estimate, name: str, options: LawOptions) -> TorqueObserver:
    """Observer with measured velocities, whose channels are aligned where they are read."""
    if estimate.torque_delays.any():
        lags = zip(estimate.leg.joint_labels, estimate.torque_delays.tolist(), strict=True)
        raise ExoidError(
            f"{name}: the measured torques lag ({', '.join(f'{joint} {1e3 * lag:g} ms' for joint, lag in lags)}), "
            "and C has no form for lags",
            remedy="where the machine's software takes them out, write the observer in Python: "
            f"exoid.codegen.write_c(path, {OBSERVERS[name].__name__}(est, ..., torque_delay=0.0))",
        )
    bandwidth = OBSERVED if options.bandwidth is None else options.bandwidth
    return OBSERVERS[name](estimate, bandwidth, _rate(options, 100.0), torque_delay=0.0)


def _with_gains(source: Estimate | ControlModel, name: str, options: LawOptions) -> AnyLaw:
    """Law with gains, which has a gait to follow; adaptive control needs the covariance of the estimate."""
    model = ControlModel.of(source)
    leg, labels = model.leg, model.leg.joint_labels
    period = PERIOD if options.period is None else options.period
    if not 0.0 < period < np.inf:
        raise ExoidError(f"--period {period:g}", remedy="give seconds")
    reference = experiments.gait_for_leg(leg, experiments.healthy_gait(SCALE, period), roles_of(options.role))
    kp, kd = control.default_gains(model, control.mean_pose(reference, period))
    if options.kp is not None:
        kp = joint_values(options.kp, "--kp", labels, one_for_all=True)
        kd = 0.1 * kp
    if options.kd is not None:
        kd = joint_values(options.kd, "--kd", labels, one_for_all=True)
    rate = _rate(options, 100.0)
    if name == "impedance":
        return control.impedance(model, kp, kd, rate=rate)
    return control.standard_laws(source, kp, kd, reference, period, rate=rate, names=[name])[name]


def _rate(options: LawOptions, default: float) -> float:
    return default if options.rate is None else options.rate


def _limited(law: AnyLaw, estimate: Estimate, options: LawOptions) -> control.Limited:
    """Limit the torque; the URDF's limit of zero means that it has none."""
    effort, labels = estimate.leg.limits.effort, estimate.leg.joint_labels
    limit = np.where(effort > 0.0, effort, np.inf)
    if options.limit is not None:
        limit = joint_values(options.limit, "--limit", labels, one_for_all=True)
    slew = np.full(len(labels), np.inf)
    if options.slew is not None:
        slew = joint_values(options.slew, "--slew", labels, one_for_all=True)
    return control.Limited(law, limit, slew)


def _refuse_foreign(name: str, options: LawOptions) -> None:
    """Refuse options of another law."""
    gains, limits = ("kp", "kd", "period", "role"), ("limit", "slew")
    foreign = {
        "gravity_support": (*gains, "amplification", "bandwidth"),
        "sensitivity_amplification": (*gains, "share"),
        **dict.fromkeys(OBSERVERS, (*gains, *limits, "share", "amplification")),
    }.get(name, ("share", "amplification", "bandwidth"))
    refuse({f"--{option}": getattr(options, option) for option in foreign}, f"{name} has none")
