"""``exoid identify --own``: several logs with shared and per-recording parameters."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypedDict

from exoid import identification
from exoid.actuators import Actuators, Coupling, Drive
from exoid.errors import ExoidError
from exoid.estimate.file import estimate_text
from exoid.leg.leg import Leg
from exoid.signals import Recording
from exoid.tools.files import write_together
from exoid.torques import Term


class Settings(TypedDict):
    """Settings of an identification, of one leg or several."""

    terms: tuple[Term, ...] | None
    estimator: str
    cutoff: float | None
    preparation: str | None
    noise: str
    known: dict[str, float]
    prior: dict[str, tuple[float, float]]
    nonnegative: bool
    delay: str | None
    check: bool


class GroupedLogs(NamedTuple):
    """Logs with shared and per-recording parameters."""

    names: Sequence[str]  # names of the logs
    own: Sequence[str]  # per-recording parameters
    paths: Mapping[str, Path]  # file of the estimate of each log, by its name; empty to write none

    @staticmethod
    def of(names: Sequence[str], own: Sequence[str], output: str | None) -> GroupedLogs:
        """Name the file of each log's estimate after the log, such as est-monday.json."""
        path = Path(output or "")
        files = {} if output is None else {n: path.with_name(f"{path.stem}-{_plain(n)}{path.suffix}") for n in names}
        return GroupedLogs(names, own, files)

    def identify(
        self,
        recordings: Sequence[Recording],
        find: Callable[[Sequence[str]], Leg],
        read_drives: Callable[[Leg], Actuators | None],
        settings: Settings,
        *,
        as_json: bool,
    ) -> str:
        """Identify, write all estimates or none, and describe the result."""
        known = {each.joint_names: find(each.joint_names) for each in recordings}
        legs = {name: known[each.joint_names] for name, each in zip(self.names, recordings, strict=True)}
        groups = dict(zip(self.names, recordings, strict=True))
        drives: dict[str, Drive | Coupling] = {}
        for leg in known.values():
            mounted = read_drives(leg)
            if mounted is not None:
                couplings = {f"{name} of {', '.join(each.joints)}": each for name, each in mounted.couplings.items()}
                drives |= {**mounted.drives, **couplings}
        found = identification.identify(legs, groups, own=self.own, actuators=drives or None, **settings)
        write_together({path: estimate_text(found[name]) for name, path in self.paths.items()})
        if not as_json:
            return str(found)
        data = found.to_json()
        for estimate in data["groups"].values():
            del estimate["leg"]["urdf"]
        return json.dumps(data, indent=1)


def log_names(logs: Sequence[str]) -> list[str]:
    """Name each log by its file name without folder and ending if these names differ, else by the argument."""
    stems = [Path(log).stem for log in logs]
    names = stems if len(set(stems)) == len(stems) else list(logs)
    if len(set(names)) != len(names) or len(names) < 2:
        what = "one log was given twice" if len(names) > 1 else "there is only one log"
        raise ExoidError(f"--own names per-recording parameters, but {what}", remedy="give several logs, or no --own")
    return names


def _plain(name: str) -> str:
    """Replace characters that a file name should not have."""
    return "".join(letter if letter.isalnum() or letter in "._" else "-" for letter in name)
