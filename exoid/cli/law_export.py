"""Control laws of ``exoid export --law``: from options to a law, and to its C."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from exoid import control
from exoid.codegen import Safety, write_c, write_ros2
from exoid.codegen.drives import with_form_in_c
from exoid.control import ControlModel
from exoid.errors import BadArgumentError, NotSupportedError, nearest
from exoid.estimate.text import provenance

from .export_options import LawOptions, Target
from .motions import gait_or_rest
from .numbers import joint_values, parse_gains
from .refusals import refuse

if TYPE_CHECKING:
    from exoid.codegen import CSource
    from exoid.control.law import AnyLaw
    from exoid.estimate import Estimate

WORN = ("gravity_support", "sensitivity_amplification", "impedance")
"""Names of the laws for a leg with a wearer."""

OBSERVER = "momentum_observer"
"""Name of the observer, which gives the torque of the wearer in place of a command."""

GROUND = ("stance", "coordinated")
"""Names of the law of a machine on the ground, alone and with its contacts and functions."""


def export_law(estimate: Estimate, target: Target, options: LawOptions) -> CSource:
    """Write a law for an estimate as C, or as a package for ROS 2."""
    # Gains, rate and gait are those of `exoid track` unless options say otherwise; the limit is that of the URDF.
    name, default = str(target.law), Safety()
    gains = ("kp", "kd", "role")
    foreign = {
        "gravity_support": (*gains, "amplification", "bandwidth"),
        "sensitivity_amplification": (*gains, "share"),
        OBSERVER: (*gains, "limit", "slew", "share", "amplification"),
        "lqr": (*gains[:2], "share", "amplification", "bandwidth"),
        **dict.fromkeys(GROUND, (*gains, "slew", "share", "amplification", "bandwidth")),
    }.get(name, ("share", "amplification", "bandwidth"))
    safety = Safety(options.safe or default.safe, patience=_or(options.patience, default.patience))
    refuse({f"--{option}": getattr(options, option) for option in foreign}, f"{name} has none")
    labels = estimate.leg.joint_labels
    limit = None if options.limit is None else joint_values(options.limit, "--limit", labels)
    law: object
    if name == OBSERVER:
        law = _observer(estimate, options)
    elif name in GROUND:
        make = control.stance if name == "stance" else control.ground.CoordinatedLoop.of
        law = make(estimate, limit=limit, rate=_or(options.rate, 500.0))
    else:
        slew = np.inf if options.slew is None else joint_values(options.slew, "--slew", labels)
        most = estimate.leg.limits.effort if limit is None else limit
        law = control.Limited(_law(estimate, name, options), most, slew)
    precision, lines, warnings = target.precision or "double", provenance(estimate), estimate.warnings
    if target.ros2 is not None:
        return write_ros2(target.ros2, law, precision=precision, safety=safety, provenance=lines, warnings=warnings)
    drives, without = with_form_in_c(None if name == OBSERVER else estimate.actuators)
    warnings = (*warnings, *without)
    return write_c(
        str(target.c), law, precision=precision, safety=safety, provenance=lines, warnings=warnings, actuators=drives
    )


def _law(estimate: Estimate, name: str, options: LawOptions) -> AnyLaw:
    model = ControlModel.of(estimate)
    labels, rate = model.leg.joint_labels, _or(options.rate, 100.0)
    if name == "gravity_support":
        share = 1.0 if options.share is None else joint_values(options.share, "--share", labels)
        return control.gravity_support(model, share, rate=rate)
    if name == "sensitivity_amplification":
        amplification = joint_values(options.amplification or "2", "--amplification", labels)
        bandwidth, rate = _or(options.bandwidth, 20.0), _or(options.rate, 500.0)
        return control.sensitivity_amplification(model, amplification, bandwidth=bandwidth, rate=rate)
    known = (*control.LAWS, *WORN, OBSERVER, *GROUND)
    if name not in known:
        remedy = f"{nearest(name, known)}use one of {', '.join(known)}"
        raise BadArgumentError(f"--law {name}: no such controller", remedy=remedy)
    reference, period, _ = gait_or_rest(model.leg, options.role)
    usual = control.default_gains(model, control.mean_pose(reference, period), rate)
    kp, kd = parse_gains(options.kp, options.kd, labels, usual)
    if name == "impedance":
        return control.impedance(model, kp, kd, rate=rate)
    return control.standard_laws(model, kp, kd, reference, period, rate=rate, names=[name])[name]


def _observer(estimate: Estimate, options: LawOptions) -> control.MomentumObserver:
    """Observer with measured velocities, whose channels are aligned where they are read."""
    if estimate.torque_delays.any():
        lags = zip(estimate.leg.joint_labels, estimate.torque_delays.tolist(), strict=True)
        raise NotSupportedError(
            f"{OBSERVER}: the measured torques lag ({', '.join(f'{joint} {1e3 * lag:g} ms' for joint, lag in lags)}), "
            "and C has no form for lags",
            remedy="where the machine's software takes them out, write the observer in Python: "
            "exoid.codegen.write_c(path, MomentumObserver(est, ..., torque_delay=0.0))",
        )
    bandwidth, rate = _or(options.bandwidth, 8.0), _or(options.rate, 100.0)
    return control.MomentumObserver(estimate, bandwidth, rate, torque_delay=0.0)


def _or(value: float | None, default: float) -> float:
    return default if value is None else value
