"""Logs of a folder, which are read one by one."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from exoid.signals import Recording, Recordings
from exoid.signals.recordings import RecordingFile, logs_in

from .inputs import read_log
from .options import LogOptions


def is_folder_of_logs(name: str) -> bool:
    """Tell whether a name is a folder of logs; a folder that is one bag is a log."""
    return os.path.isdir(name) and not os.path.isfile(Path(name) / "metadata.yaml")  # noqa: PTH112, PTH113 - no error


def each_log(names: Sequence[str]) -> list[str]:
    """Replace each folder by its logs."""
    return [str(log) for name in names for log in (logs_in(name) if is_folder_of_logs(name) else [name])]


def logs_on_disk(names: Sequence[str], options: LogOptions) -> Recordings:
    """Keep logs on disk until each is read."""
    return Recordings(tuple(RecordingFile(Path(name), partial(_read, options)) for name in names))


def _read(options: LogOptions, path: Path) -> Recording:
    return read_log(str(path), options)
