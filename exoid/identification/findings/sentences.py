"""What the faults of a fit mean, and what to do about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, Severity
from exoid.torques import TorqueModel

from .faults import DOUBTFUL_MOVE, FaultSize
from .least_sizes import is_large_enough
from .nuisances import Nuisance
from .score import HALF_WIDTH, Score


def findings_of(model: TorqueModel, sizes: Sequence[FaultSize]) -> tuple[Finding, ...]:
    """Describe faults that were found."""
    findings: dict[tuple[str, str], Finding] = {}
    for size in sizes:
        doubtful = size.doubtful
        if size.moves_far:  # too large for a linear estimate of what it moves
            doubtful |= _acting(model, size.fault.nuisance.joint) & (size.half > 0.0)
        moved = [name for name, is_doubtful in zip(model.names, doubtful, strict=True) if is_doubtful]
        severity: Severity = "error" if size.severe else "warning"
        finding = describe_fault(size.fault.nuisance, size.delta, HALF_WIDTH * size.std, severity).affecting(moved)
        others = [
            one
            for one in size.fault.alternatives
            if (one.nuisance.kind, one.nuisance.joint) != (finding.kind, finding.joint)
            and is_large_enough(one.nuisance, one.delta, size.torque)
        ]
        for one in _undecided(model, finding, others):
            place = (one.kind, one.joint)
            if place in findings:  # another form of the same fault
                first = findings[place]
                findings[place] = first.affecting(tuple(dict.fromkeys((*first.parameters, *one.parameters))))
            else:
                findings[place] = one
    return tuple(findings.values())


def _undecided(model: TorqueModel, finding: Finding, alternatives: Sequence[Score]) -> Iterator[Finding]:
    """A finding, and one for each other fault that explains the log about as well."""
    if not alternatives:
        yield finding
        return
    both = [finding]
    for one in alternatives:
        moved = np.divide(np.abs(one.move), one.half, out=np.zeros_like(one.move), where=one.half > 0.0) > DOUBTFUL_MOVE
        names = [name for name, is_moved in zip(model.names, moved, strict=True) if is_moved]
        half = HALF_WIDTH * np.sqrt(np.diag(one.covariance))
        both.append(describe_fault(one.nuisance, one.delta, half, finding.severity).affecting(names))
    names_of = [f"{found.kind} at {found.joint}" if found.joint else found.kind for found in both]
    for k, found in enumerate(both):
        others = " or ".join((*names_of[:k], *names_of[k + 1 :]))
        yield replace(found, message=f"{found.message}; {others} would explain this log about as well")


def _acting(model: TorqueModel, joint: str) -> NDArray[np.bool_]:
    """Which parameters act on a joint, or on any where it has no name, (P,)."""
    at = model.acting if not joint else model.acting[[model.joint_names.index(joint)]]
    return np.asarray(at.any(axis=0))


def describe_fault(nuisance: Nuisance, delta: FloatArray, half: FloatArray, severity: Severity) -> Finding:
    """Write a finding for a fault with its size."""
    value = float(delta[0]) if len(delta) == 1 else float(np.linalg.norm(delta))
    ends = [value - float(half[0]), value + float(half[0])] if len(delta) == 1 else []
    if len(delta) == 1:
        value, *ends = (_as_reported(nuisance.kind, number) for number in (value, *ends))
    interval = (min(ends), max(ends)) if ends else None
    joint = nuisance.joint
    whose = f"the torque of {joint}" if joint else "the torque of all joints"
    message, remedy = {
        "torque-delay": (
            f"{whose} comes {1e3 * abs(value):.3g} ms {'after' if value > 0.0 else 'before'} the motion"
            + (", or its sensor has a low-pass of that time constant" if value > 0.0 else ""),
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
            "level the base, or give its tilt: Recording(torso=TorsoMotion(pitch=...)); calibrate the "
            "accelerometer of a moving base",
        ),
        "segment-length": (
            f"the segment behind {joint} is {100.0 * value:+.3g} % longer than in the URDF, or the clock of the log is "
            "off by half of that",
            "measure the distance between the joint axes and correct the URDF; compare the log with another clock",
        ),
        "clock": (
            f"the motion is {100.0 * abs(value):.3g} % {'faster' if value > 0.0 else 'slower'} than the time stamps "
            "say: coupling and gravity contradict each other",
            "compare the stamps with another clock, and check the lengths of all segments",
        ),
        "unmodelled-friction": (
            f"the residual of {joint} depends on its velocity or load as {nuisance.form} does",
            "compare terms with exoid select: Stribeck friction, friction under load, presliding",
        ),
        "unmodelled-force": (
            f"the residual of {joint} depends on the angles as the force of a strap, a cable or a spring does",
            "remove the strap or cable, or add the term stiffness",
        ),
        "moment-arm": (
            f"the moment arm of the actuator at {joint} has another shape than described: as if the {nuisance.form} "
            + (
                f"were {1e3 * value:.2g} mm elsewhere"
                if nuisance.unit == "m"
                else f"were off by {value:.2g} of the arm"
            ),
            "measure both attachment points in the frames of their links, or the moment arm over the angle",
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
