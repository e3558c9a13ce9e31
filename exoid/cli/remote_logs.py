"""Logs of a folder, which are read one by one."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from exoid.signals import Poses, Recording, Recordings
from exoid.signals.recordings import RecordingFile, logs_in

from .inputs import read_log
from .options import LogOptions
from .progress import progress_bar

PASSES = 2
"""Number of times that each log is read: once for its summary, and once for its rows."""


def is_folder_of_logs(name: str) -> bool:
    """Tell whether a name is a folder of logs; a folder that is one bag is a log."""
    return os.path.isdir(name) and not os.path.isfile(Path(name) / "metadata.yaml")  # noqa: PTH112, PTH113 - no error


def each_log(names: Sequence[str]) -> list[str]:
    """Replace each folder by its logs."""
    return [str(log) for name in names for log in (logs_in(name) if is_folder_of_logs(name) else [name])]


def logs_on_disk(names: Sequence[str], options: LogOptions) -> Recordings:
    """Keep logs on disk until each is read."""
    return Recordings(tuple(RecordingFile(Path(name), partial(_read, options)) for name in names))


@contextmanager
def with_progress(logs: Sequence[Recording | Poses]) -> Iterator[Sequence[Recording | Poses]]:
    """Show a progress bar while logs are read from a disk."""
    if not isinstance(logs, Recordings):
        yield logs
        return
    read = 0
    total = PASSES * len(logs)
    with progress_bar("identifying") as progress:

        def count(_: object) -> None:
            """Count a log that was read, and show the share."""
            nonlocal read
            read += 1
            progress(min(1.0, read / total))

        yield replace(logs, watch=count)


def _read(options: LogOptions, path: Path) -> Recording:
    return read_log(str(path), options)
