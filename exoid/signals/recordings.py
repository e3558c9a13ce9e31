"""Recordings that stay on disk until their turn comes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple, overload

from exoid.errors import ExoidError

from . import checks
from .formats import READERS
from .poses import Poses
from .recording import Recording


class Stored(NamedTuple):
    """A recording on disk.

    Attributes:
        path: Its file.
        read: Reads it.
    """

    path: Path
    read: Callable[[Path], Recording]

    def load(self) -> Recording:
        """Read it.

        Raises:
            ExoidError: The file cannot be trusted.
        """
        return self.read(self.path)


@dataclass(frozen=True, eq=False)
class Recordings(Sequence[Recording | Poses]):
    """Logs of a folder, each of which is read when it is looked at, and not kept: together they may exceed memory.

    What takes recordings takes these. Each file is a recording of its own: the filters spoil its ends, and friction
    with a memory begins anew.

    Attributes:
        items: Files, and recordings or poses that are in memory.
        watch: Called whenever a file has been read, such as by a progress bar.

    Example:
        >>> est = exoid.identify(leg, Recordings.from_folder("logs"))  # doctest: +SKIP
    """

    items: tuple[Stored | Recording | Poses, ...]
    watch: Callable[[Path], None] | None = None

    @staticmethod
    def from_folder(
        folder: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str] | None = None,
        *,
        angle_unit: Literal["rad", "deg"] = "rad",
        largest_angle: float = checks.LARGEST_ANGLE,
        topic: str | None = None,
        stamps: Literal["header", "received"] = "header",
    ) -> Recordings:
        """Find the logs in a folder, those of its folders not; ``part.10.csv`` comes after ``part.9.csv``.

        Args:
            folder: The folder.
            joint_names: See :meth:`Recording.from_file`, which reads each file; the other arguments too.
            columns: See there.
            angle_unit: See there.
            largest_angle: See there.
            topic: See there.
            stamps: See there.

        Raises:
            ExoidError: There is no such folder, or no log in it.
        """
        return Recordings.from_files(
            logs_in(folder),
            joint_names,
            columns,
            angle_unit=angle_unit,
            largest_angle=largest_angle,
            topic=topic,
            stamps=stamps,
        )

    @staticmethod
    def from_files(
        paths: Iterable[str | os.PathLike[str]],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str] | None = None,
        *,
        angle_unit: Literal["rad", "deg"] = "rad",
        largest_angle: float = checks.LARGEST_ANGLE,
        topic: str | None = None,
        stamps: Literal["header", "received"] = "header",
    ) -> Recordings:
        """Take these files, in this order; arguments as for :meth:`Recording.from_file`, which reads each."""
        read = partial(
            Recording.from_file,
            joint_names=joint_names,
            columns=columns,
            angle_unit=angle_unit,
            largest_angle=largest_angle,
            topic=topic,
            stamps=stamps,
        )
        return Recordings(tuple(Stored(Path(path), read) for path in paths))

    def watched(self, watch: Callable[[Path], None]) -> Recordings:
        """Return the same, calling this whenever a file has been read."""
        return replace(self, watch=watch)

    def at_rest(self, index: int) -> bool:
        """Say whether one of them is poses, without reading it."""
        return isinstance(self.items[index], Poses)

    def __len__(self) -> int:
        return len(self.items)

    @overload
    def __getitem__(self, index: int) -> Recording | Poses: ...

    @overload
    def __getitem__(self, index: slice) -> Recordings: ...

    def __getitem__(self, index: int | slice) -> Recording | Poses | Recordings:
        """Read one, or choose several."""
        if isinstance(index, slice):
            return replace(self, items=self.items[index])
        item = self.items[index]
        if not isinstance(item, Stored):
            return item
        recording = item.load()
        if self.watch is not None:
            self.watch(item.path)
        return recording

    def __iter__(self) -> Iterator[Recording | Poses]:
        """Read one after the other."""
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"Recordings({len(self)})"


def logs_in(folder: str | os.PathLike[str]) -> list[Path]:
    """List the logs in a folder, numbers in their names in order.

    Raises:
        ExoidError: There is no such folder, or no log in it.
    """
    path = Path(folder)
    try:
        files = sorted(filter(_is_log, path.iterdir()), key=_natural)
    except OSError as error:
        raise ExoidError(f"no such folder ({error.strerror})", where=str(path), remedy="check the path") from None
    if not files:
        known = ", ".join(f".{ending}" for ending in READERS)
        raise ExoidError("no logs in the folder", where=str(path), remedy=f"give them names that end in {known}")
    return files


def _is_log(path: Path) -> bool:
    return path.suffix.lower().removeprefix(".") in READERS and not path.name.startswith(".") and path.is_file()


def _natural(path: Path) -> list[tuple[int, str]]:
    """Key that sorts numbers in names by their size."""
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if k % 2 else (0, part) for k, part in enumerate(parts)]
