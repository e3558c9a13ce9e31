"""What a recursive estimator has to say: faults of the stream, changes, and what contradicts the estimate."""

from __future__ import annotations

import numpy as np

from exoid.estimate.finding import Finding, Severity, ordered

from .settings import Settings
from .state import State
from .stream import FAULTS, Stream

FALLEN = 10.0
"""Ratio of residuals to the smallest so far from which on they contradict the intervals."""

CONTRADICTED = 3.0
"""Mean statistic of a minute from which on it is reported; 1 while only noise, and what is not yet known, errs."""

GIVEN_UP = "values before it are in changes; what was known of these parameters was given up"
WAIT = "move all joints, both ways; until then what was known of all of these parameters is given up"
LOOK = "look for what no parameter explains: contact, slip of a sensor, a person who pushes; begin anew without it"


def findings_of(settings: Settings, state: State, stream: Stream) -> tuple[Finding, ...]:
    """List them, the worst first."""
    found: list[Finding] = []
    hypotheses, mean = settings.detection.hypotheses, state.detector.mean

    def say(kind: str, joint: str, size: float, text: str, remedy: str, names: tuple[str, ...] = ()) -> None:
        level: Severity = "info" if remedy == GIVEN_UP else "warning"
        found.append(Finding(kind, joint, size, "", level, text, remedy, parameters=names))

    for change in state.changes:
        text = f"{', '.join(change.parameters)} changed at {change.time:.2f} s"
        say(f"changed-{change.kind}", change.joint, change.statistic, text, GIVEN_UP, change.parameters)
    possible = [hypotheses[k] for k in state.detector.candidates]
    names = tuple(dict.fromkeys(name for one in possible for name in one.parameters))
    if len(possible) == len(hypotheses):
        text = "torques that no single change explains: all that was known is given up until they are over"
        say("change-unexplained", "", 1.0, text, LOOK, names)
    elif len(possible) > 1:
        text = " or ".join(f"{one.kind} at {one.joint}" for one in possible)
        text = f"something changed, and the motion does not yet tell {text} apart"
        say("change-ambiguous", "", 1.0, text, WAIT, names)
    for joint, now, best in zip(settings.model.joint_names, state.weights, state.sharpest, strict=True):
        if best > FALLEN * now:
            say(
                "residuals-grew",
                joint,
                best / now,
                f"residuals of {joint} are {best / now:.3g} times what they were",
                LOOK,
            )
    for k in np.flatnonzero(mean > CONTRADICTED):
        one, size = hypotheses[k], float(mean[k])
        text = f"torques contradict {', '.join(one.parameters)}: errors are {size**0.5:.3g} times the intervals'"
        say("intervals-contradicted", one.joint, size, text, LOOK, one.parameters)
    for (kind, (message, remedy)), number in zip(FAULTS.items(), stream.counts, strict=True):
        if number:
            share, text = number / max(stream.received, 1), f"{number} of {stream.received} {message}"
            level: Severity = "warning" if share > 1e-3 else "info"
            found.append(Finding(f"stream-{kind}", "", share, "", level, text, remedy))
    return ordered(tuple(found))
