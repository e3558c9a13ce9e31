"""``exoid select``: friction of each joint, filter and estimator that predict best."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from typer import Option

import exoid
from exoid.errors import BadArgumentError

from .inputs import read_drives, read_logs
from .legs import refuse_unknown_leg
from .numbers import split_names
from .option_groups import expand_options
from .options import (
    ANY_LEG,
    FIXED_BASE,
    READ_AS_IT_IS,
    AsJson,
    DriveFile,
    EstimateOutput,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    Number,
    Text,
)
from .outputs import check_outputs, print_result
from .progress import progress_bar

if TYPE_CHECKING:
    from exoid.identification.selection import Candidate


@expand_options(without=FIXED_BASE)
def select(
    leg: LegName,
    logs: LogNames,
    output: EstimateOutput = None,
    test: Annotated[Text, Option(metavar="LOG", help="Validate the selected model, once, on another log.")] = None,
    friction: Annotated[
        Text,
        Option(
            metavar="A,B",
            help="Models for all joints alike, of coulomb, asymmetric, stribeck, load, load+split, presliding, and "
            "presliding with +stribeck or +load; default: friction joint by joint.",
        ),
    ] = None,
    folds: Annotated[int, Option(min=3, help="Blocks of each log, each predicted from the others.")] = 5,
    cutoff: Annotated[
        Number,
        Option(metavar="HZ", help="Low-pass of the compared torques; default: 8, less for logs below 20 Hz."),
    ] = None,
    choice: LegOptions = ANY_LEG,
    reading: LogOptions = READ_AS_IT_IS,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Select terms, filter and estimator for LEG by blocked cross-validation inside the LOGs.

    Example: exoid select bleex bleex_swing:train --friction coulomb
    """
    from exoid.signals.default_preparation import highest_cutoff  # noqa: PLC0415 - help needs no filters

    refuse_unknown_leg(leg)
    check_outputs({"--output": output}, [leg, *logs, test])
    tests = [] if test is None else [test]
    recordings = read_logs(logs, reading, beside=tests)
    tested = read_logs(tests, reading._replace(start=None, stop=None), beside=logs)
    found = choice.find(leg, recordings[0].joint_names)
    if cutoff is None:
        cutoff = highest_cutoff(min(recording.sample_rate for recording in recordings))
    drives = read_drives(actuators, found)
    if drives is not None:
        recordings, tested = ([drives.torque(each) for each in logged] for logged in (recordings, tested))
    with progress_bar("selecting friction") as progress:
        selection = exoid.identification.select_terms(
            found, recordings, _candidates(friction, cutoff), folds=folds, cutoff=cutoff, progress=progress
        )
    estimate = selection.estimate or selection.identify(recordings)
    if output is not None:
        estimate.save(output)
    data, text = selection.to_json(), [str(selection), str(estimate)]
    for each in tested:
        validation = selection.validate(estimate, each)
        data["test"] = validation.to_json()
        text.append(str(validation))
    print_result("\n\n".join(text), as_json=as_json, data=data)


def _candidates(names: str | None, cutoff: float) -> list[Candidate] | None:
    """Find friction models by name; None to choose the friction of each joint."""
    from exoid.identification.selection import friction_candidates  # noqa: PLC0415

    requested = split_names(names)
    if requested is None:
        return None
    known = {candidate.name: candidate for candidate in friction_candidates(cutoff)}
    missing = [name for name in requested if name not in known]
    if missing:
        raise BadArgumentError(f"no friction model {', '.join(missing)}", remedy=f"use some of {', '.join(known)}")
    return [known[name] for name in requested]
