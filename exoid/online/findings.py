"""What a recursive estimator has to say: faults of the stream, changes, and what contradicts the estimate."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid.estimate import Estimate
from exoid.estimate.finding import Finding, Severity, ordered
from exoid.identification.findings.efforts import FITS_BETTER, fit_torques
from exoid.identification.findings.physics import impossible_leg, odd_scales, other_scale
from exoid.identification.findings.sample import FittedLeg

from .hypotheses import SENSOR_FAULTS
from .settings import Settings
from .state import State
from .stream import FAULTS, Stream

CLOCKS = 5e-4
"""Difference of rates that two clocks may have: by so much one is slewed where they are kept together."""

FALLEN, CONTRADICTED = 10.0, 3.0
"""Ratio of residuals to the smallest so far, and mean statistic of a minute (1 for noise) that contradict intervals."""

POOR, PERSISTENT = 0.5, 0.15
"""Share of a joint's torque that no estimate should leave unexplained; where residuals last longer than noise does.

Healthy streams of `study_online.py` and `study_loads.py` leave 0.1 at most, channels of another sign or order 0.2.
"""

HELD = "mend the sensor, or begin anew with this estimate as start=: it holds what was known before, and learns nothing"
OVER = "it is over, and what was known before is known again"
GIVEN_UP = "values before it are in changes; what was known of these parameters was given up"
WAIT = "move all joints, both ways; until then what was known of all of these parameters is given up"
LOOK = "look for what no parameter explains: contact, slip of a sensor, a person who pushes; begin anew without it"


def findings_of(settings: Settings, state: State, stream: Stream) -> tuple[Finding, ...]:
    """List them, the worst first."""
    found: list[Finding] = []
    hypotheses, mean = settings.detection.hypotheses, state.detector.mean

    def say(kind: str, joint: str, size: float, text: str, remedy: str, names: tuple[str, ...] = ()) -> None:
        level: Severity = "info" if remedy in (GIVEN_UP, OVER) else "warning"
        found.append(Finding(kind, joint, size, "", level, text, remedy, parameters=names))

    for change in state.changes:
        lasts = change is state.changes[-1] and state.detector.named >= 0
        size, remedy = change.statistic, GIVEN_UP
        if change.kind in SENSOR_FAULTS:
            size, remedy = change.size, HELD if lasts else OVER
        say(f"changed-{change.kind}", change.joint, size, str(change), remedy, change.parameters)
    possible = [hypotheses[k] for k in state.detector.candidates]
    names = tuple(dict.fromkeys(name for one in possible for name in one.parameters))
    if len(possible) == len(hypotheses):
        text = "torques that no single change explains: all that was known is given up until they are over"
        say("change-unexplained", "", 1.0, text, LOOK, names)
    elif len(possible) > 1:
        text = " or ".join(f"{one.kind} at {one.joint or 'all joints'}" for one in possible)
        text = f"something changed, and the motion does not yet tell {text} apart"
        say("change-ambiguous", "", 1.0, text, WAIT, names)
    for joint, now, best in zip(settings.model.leg.joint_names, state.weights, state.sharpest, strict=True):
        if best > FALLEN * now:
            text = f"residuals of {joint} are {best / now:.3g} times what they were"
            say("residuals-grew", joint, best / now, text, LOOK)
    for k in np.flatnonzero(mean > CONTRADICTED):
        one, size = hypotheses[k], float(mean[k])
        text = f"torques contradict {', '.join(one.parameters)}: errors are {size**0.5:.3g} times the intervals'"
        say("intervals-contradicted", one.joint, size, text, LOOK, one.parameters)
    passed, rounded, samples = stream.periods
    # Samples that are lost only make the others slow; stamps that come in bursts are rounded to too few periods
    pace = min(passed / max(samples, 1), max(1.0, passed / max(rounded, 1)))
    if samples > 100 and abs(pace - 1.0) > CLOCKS + 10.0 / samples:
        text = f"samples come at {settings.rate / pace:.7g} Hz by their time stamps, not at {settings.rate:.7g} Hz"
        say("stream-rate", "", pace, text, "make the estimator with the rate of the samples", settings.model.names)
    ways, products = stream.travel
    for joint, way, product in zip(settings.model.leg.joint_names, ways.tolist(), products.tolist(), strict=False):
        if way > 0.0 and abs(product / way - 1.0) > 0.02:  # a delay of 20 ms takes 1 % of a usual gait's
            text = f"the velocity is {product / way:.3g} times the derivative of the angle"
            remedy = "pass no velocity (v=None), or mend its unit or sign"
            say("velocity-scale", joint, product / way, text, remedy, settings.model.names)
    for (kind, (message, remedy)), number in zip(FAULTS.items(), stream.counts, strict=True):
        if number > 0:
            share, text = number / max(stream.received, 1), f"{number} of {stream.received} {message}"
            level: Severity = "warning" if share > 1e-3 else "info"
            found.append(Finding(f"stream-{kind}", "", share, "", level, text, remedy))
    return ordered(tuple(found))


def doubts_of(estimate: Estimate, state: State) -> Iterator[Finding]:
    """Find what says that an estimate cannot be right: links that do not exist, torques unexplained or reversed."""
    factors, rows = state.information.R[:-1], np.maximum(state.information.rows[:-1], 1.0)
    impossible = list(impossible_leg(estimate.model.leg, estimate.values, estimate.covariance, factors))
    yield from impossible
    units = [
        other_scale(joint, abs(size), estimate.names) for joint, size in odd_scales(estimate.model, factors).items()
    ]
    yield from (unit for unit in units if unit.severity == "error")
    torque = np.linalg.norm(factors[:, :, -1], axis=1) / np.sqrt(rows)
    sums = state.correlation.sums
    lasts = sums[3] > 0.5 * sums[0]  # half a period of the cut-off apart, noise is hardly alike any more
    shares = np.divide(estimate.residual_rms, torque, out=np.zeros_like(torque), where=torque > 0.0)
    poor = shares > np.where(lasts, PERSISTENT, POOR)
    for joint, share in zip(np.array(estimate.joint_names)[poor].tolist(), shares[poor].tolist(), strict=True):
        text = f"the model leaves {share:.0%} of the torque unexplained"
        remedy = "look for swapped or late channels, wrong signs and units (exoid check with a log of this stream)"
        yield Finding("large-residual", joint, share, "1", "warning", text, remedy)
    if not (impossible or poor.any()):
        return
    # a torque, or all of them, that the model explains once it is negated
    model, n, free = estimate.model, len(factors), np.full(len(estimate.names), np.nan)
    fitted = FittedLeg(model, (), estimate.preparation, free, estimate.values, estimate.covariance)
    tables = [np.hstack([R[:, :-1], np.outer(R[:, -1], np.arange(n) == j)]) for j, R in enumerate(factors)]
    signs = np.vstack([np.ones(n), 1.0 - 2.0 * np.eye(n), -np.ones(n)])
    plain, *others = (fit_torques(fitted, tables, factors=one.tolist())[0] for one in signs)
    best = int(np.argmin(np.sum(others, axis=1)))
    ratio = float(np.exp(0.5 * (plain - others[best]).sum()))  # of two joints
    if ratio > FITS_BETTER and others[best].max() < np.log(PERSISTENT):
        joint = (*model.leg.joint_names, "")[best]
        what = f"the torque of {joint} or its angle" if joint else "all torques or all angles"
        text = f"the sign of {what} is wrong: residuals are {ratio:.3g} times smaller with the other one"
        yield Finding("torque-sign", joint, -1.0, "1", "error", text, "negate the wrong one", parameters=model.names)
