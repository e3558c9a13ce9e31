"""``exoid identify --own``: several logs with shared and per-recording parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from exoid import identification
from exoid.actuators import Actuators, Coupling, Drive
from exoid.errors import BadArgumentError
from exoid.estimate.file import estimate_text
from exoid.leg.leg import Leg
from exoid.signals import Recording
from exoid.tools.files import write_together


def identify_grouped(
    recordings: Mapping[str, Recording],
    own: Sequence[str],
    find: Callable[[Sequence[str]], Leg],
    read_drives: Callable[[Leg], Actuators | None],
    columns: Mapping[str, Any],
    settings: Mapping[str, Any],
    paths: Mapping[str, Path],
) -> tuple[str, dict[str, Any]]:
    """Identify, write all estimates or none, and describe the result as text and in JSON types."""
    known = {each.joint_names: find(each.joint_names) for each in recordings.values()}
    legs = {name: known[each.joint_names] for name, each in recordings.items()}
    drives: dict[str, Drive | Coupling] = {}
    for leg in known.values():
        mounted = read_drives(leg)
        if mounted is not None:
            couplings = {f"{name} of {', '.join(each.joints)}": each for name, each in mounted.couplings.items()}
            drives |= {**mounted.drives, **couplings}
    found = identification.identify(legs, recordings, own=own, actuators=drives or None, **settings)
    write_together({path: estimate_text(replace(found[name], columns=columns)) for name, path in paths.items()})
    data = found.to_json()
    for estimate in data["groups"].values():
        del estimate["leg"]["urdf"]
    return str(found), data


def log_names(logs: Sequence[str]) -> list[str]:
    """Name each log by its file name without folder and ending if these names differ, else by the argument."""
    stems = [Path(log).stem for log in logs]
    names = stems if len(set(stems)) == len(stems) else list(logs)
    if len(set(names)) != len(names) or len(names) < 2:
        what = "one log was given twice" if len(names) > 1 else "there is only one log"
        remedy = "give several logs, or no --own"
        raise BadArgumentError(f"--own names per-recording parameters, but {what}", remedy=remedy)
    return names


def estimate_files(names: Sequence[str], output: str | None) -> dict[str, Path]:
    """Name the file of each log's estimate after the log, such as est-monday.json; none without an output."""
    path = Path(output or "")
    plain = {name: "".join(c if c.isalnum() or c in "._" else "-" for c in name) for name in names}
    return {} if output is None else {n: path.with_name(f"{path.stem}-{plain[n]}{path.suffix}") for n in names}
