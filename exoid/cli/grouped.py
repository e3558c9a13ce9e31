"""``exoid identify --own``: several logs, each with some parameters of its own."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypedDict

from exoid import identification
from exoid.errors import ExoidError
from exoid.estimate.file import estimate_text
from exoid.files import refuse_unwritable, write_together
from exoid.leg import Leg
from exoid.signals import Recording
from exoid.torques import Term


class Settings(TypedDict):
    """How to identify, one leg or several."""

    terms: tuple[Term, ...]
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
    """Logs that share parameters, and have some of their own.

    Attributes:
        names: Of the logs.
        own: Parameters that each has of its own.
        paths: Where the estimate of each is written, by its name; empty for nowhere.
    """

    names: Sequence[str]
    own: Sequence[str]
    paths: Mapping[str, Path]

    @staticmethod
    def of(names: Sequence[str], own: Sequence[str], output: str | None) -> GroupedLogs:
        """Name the file of each log's estimate after it, such as est-monday.json.

        Raises:
            ExoidError: One cannot be written.
        """
        path = Path(output or "")
        files = {} if output is None else {n: path.with_name(f"{path.stem}-{_plain(n)}{path.suffix}") for n in names}
        for each in files.values():
            refuse_unwritable(each)
        return GroupedLogs(names, own, files)

    def identify(
        self,
        recordings: Sequence[Recording],
        find: Callable[[Sequence[str]], Leg],
        settings: Settings,
        *,
        as_json: bool,
    ) -> str:
        """Identify, write all estimates or none, and say what was found.

        Args:
            recordings: One for each name.
            find: Finds the leg of the joints that were logged.
            settings: How to identify.
            as_json: Whether to say it in JSON.
        """
        known = {each.joint_names: find(each.joint_names) for each in recordings}
        legs = {name: known[each.joint_names] for name, each in zip(self.names, recordings, strict=True)}
        groups = dict(zip(self.names, recordings, strict=True))
        found = identification.identify(legs, groups, own=self.own, **settings)
        write_together({path: estimate_text(found[name]) for name, path in self.paths.items()})
        if not as_json:
            return str(found)
        data = found.to_json()
        for estimate in data["groups"].values():
            del estimate["leg"]["urdf"]
        return json.dumps(data, indent=1)


def log_names(logs: Sequence[str]) -> list[str]:
    """Name each log: its file's name without folder and ending where that tells all apart, else as it was given.

    Raises:
        ExoidError: There is one log only, or one was given twice.
    """
    stems = [Path(log).stem for log in logs]
    names = stems if len(set(stems)) == len(stems) else list(logs)
    if len(set(names)) != len(names) or len(names) < 2:
        what = "one log was given twice" if len(names) > 1 else "there is one log only"
        raise ExoidError(f"--own says what differs from log to log, but {what}", remedy="give several, or no --own")
    return names


def _plain(name: str) -> str:
    """What of a name can stand in that of a file."""
    return "".join(letter if letter.isalnum() or letter in "._" else "-" for letter in name)
