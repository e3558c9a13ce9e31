"""Logs that are not all read at once: those of a folder, and those that the workers of a cluster read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from exoid.signals import Cluster, Poses, Recording, Recordings
from exoid.signals.recordings import RecordingFile, logs_in

from .inputs import LogOptions, read_log

PASSES = 2
"""Each log is read so often: once to look it through, and once for its rows."""


def is_folder_of_logs(name: str) -> bool:
    """Say whether a word means a folder of logs; a folder that is one bag is a log."""
    path = Path(name)
    return path.is_dir() and not (path / "metadata.yaml").is_file()


def each_log(names: Sequence[str]) -> list[str]:
    """Put the logs in a folder in the place of the folder."""
    return [str(log) for name in names for log in (logs_in(name) if is_folder_of_logs(name) else [name])]


def logs_on_disk(names: Sequence[str], options: LogOptions) -> Recordings:
    """Let logs stay on disk until each is looked at."""
    return Recordings(tuple(RecordingFile(Path(name), partial(_read, options)) for name in names))


@contextmanager
def at_hand(
    logs: Sequence[Recording | Poses], scheduler: str | None
) -> Iterator[Sequence[Recording | Poses] | Cluster]:
    """Give logs to whoever reads them: the workers of a Dask cluster, or this process, with a progress bar."""
    if scheduler is not None and isinstance(logs, Recordings):
        cluster = Cluster.of_files(scheduler, logs)
        with cluster.client:
            yield cluster
        return
    if not isinstance(logs, Recordings):
        yield logs
        return
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("identifying", total=PASSES * len(logs))
        yield logs.watched(lambda _: bar.advance(task))


def all_at_once(logs: Sequence[Recording | Poses]) -> list[Recording]:
    """Read what is not yet in memory."""
    return [log for log in logs if isinstance(log, Recording)]


def _read(options: LogOptions, path: Path) -> Recording:
    return read_log(str(path), options)
