"""What the faults of a fit mean, and what to do about them."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.findings import Finding, Severity

from .nuisances import Nuisance


def describe_fault(nuisance: Nuisance, delta: FloatArray, half: FloatArray, severity: Severity) -> Finding:
    """Write a finding for a fault with its size.

    Args:
        nuisance: The fault.
        delta: Its size, (m,).
        half: Half widths of the 95 % intervals, (m,).
        severity: Severity.

    Returns:
        The finding.
    """
    value = float(delta[0]) if len(delta) == 1 else float(np.linalg.norm(delta))
    ends = [value - float(half[0]), value + float(half[0])] if len(delta) == 1 else []
    if len(delta) == 1:
        value, *ends = (_as_reported(nuisance.kind, number) for number in (value, *ends))
    interval = (min(ends), max(ends)) if ends else None
    joint = nuisance.joint
    whose = f"the torque of {joint}" if joint else "the torque of all joints"
    message, remedy = {
        "torque-delay": (
            f"{whose} comes {1e3 * abs(value):.3g} ms {'after' if value > 0.0 else 'before'} the motion",
            'correct the time stamps, or identify with delay="auto" (--delay auto)',
        ),
        "torque-scale": (
            f"{whose} is {value:.3g} times what the other joints' torques ask for; one log cannot tell which of "
            "the joints is right",
            "calibrate the torque sensors: a known mass on the leg shows which one is wrong",
        ),
        "angle-offset": (
            f"the angle of {joint} reads {np.degrees(value):.3g}° too much: gravity and coupling have another phase",
            "set the zero of the encoder again, or add the offset to the logged angle",
        ),
        "angle-scale": (
            f"the angle of {joint} is logged {value:.3g} times as large as it is: its unit or gear ratio is wrong",
            "correct the unit or the counts per turn of the encoder",
        ),
        "gravity-direction": (
            f"gravity is turned by {np.degrees(value):.3g}° against the model: the base is tilted, or the zero of the "
            "first angle is wrong",
            "level the base, or give its tilt: Recording(torso=TorsoMotion(pitch=...))",
        ),
        "segment-length": (
            f"the segment behind {joint} is {100.0 * value:+.3g} % longer than in the URDF",
            "measure the distance between the joint axes and correct the URDF",
        ),
        "unmodelled-friction": (
            f"the residual of {joint} depends on its velocity, or on its load, as friction of another form does",
            "compare terms with exoid select: Stribeck friction, friction under load, presliding",
        ),
        "unmodelled-force": (
            f"the residual of {joint} depends on the angles as the force of a strap, a cable or a spring does",
            "remove the strap or cable, or add the term stiffness",
        ),
        "cross-talk": (
            f"the torque sensor of {joint} also sees the torques of other joints ({np.abs(delta).max():.1%})",
            "calibrate the sensors together, with a full matrix",
        ),
    }[nuisance.kind]
    return Finding(nuisance.kind, joint, value, nuisance.unit, severity, message, remedy, interval)


def _as_reported(kind: str, delta: float) -> float:
    """Turn the size of a fault into that of the logged value: its factor, or what it reads too much."""
    if kind == "torque-scale":
        return 1.0 + delta
    if kind == "angle-scale":
        return 1.0 / (1.0 + delta)
    return -delta if kind == "angle-offset" else delta
