"""Recordings on disk, read one at a time."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, overload

from exoid.errors import UnreadableInputError

from .column import Column
from .poses import Poses
from .readers import ReadOptions
from .readers.formats import READERS
from .readers.options import refuse_unknown_options
from .recording import Recording

if TYPE_CHECKING:
    from typing_extensions import Unpack


class RecordingFile(NamedTuple):
    """A recording on disk."""

    path: Path  # the file
    read: Callable[[Path], Recording]  # function that reads the file


@dataclass(frozen=True, eq=False)
class Recordings(Sequence[Recording | Poses]):
    """Sequence of recordings on disk, which together may exceed memory: each is read at every access and not kept.

    Functions that take recordings take this sequence. Each file is a separate recording: the filters distort its ends,
    and internal states of friction start again.

    Attributes:
        items: Files, and recordings or poses in memory.

    Example:
        >>> est = exoid.identify(leg, Recordings.from_folder("logs"))  # doctest: +SKIP
    """

    items: tuple[RecordingFile | Recording | Poses, ...]

    @staticmethod
    def from_folder(
        folder: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str | Column] | None = None,
        **options: Unpack[ReadOptions],
    ) -> Recordings:
        """Find the logs in a folder, without its subfolders; ``part.10.csv`` comes after ``part.9.csv``.

        Args:
            folder: The folder.
            joint_names: See :meth:`Recording.from_file`, which reads each file.
            columns: See :meth:`Recording.from_file`.
            **options: Options of :class:`exoid.signals.ReadOptions`, for every file.

        Returns:
            The recordings; no file is read yet.

        Raises:
            ExoidError: There is no such folder, or no log in it.
        """
        return Recordings.from_files(logs_in(folder), joint_names, columns, **options)

    @staticmethod
    def from_files(
        paths: Iterable[str | os.PathLike[str]],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str | Column] | None = None,
        **options: Unpack[ReadOptions],
    ) -> Recordings:
        """Make a sequence of files.

        Args:
            paths: The files, in order.
            joint_names: See :meth:`Recording.from_file`, which reads each file.
            columns: See :meth:`Recording.from_file`.
            **options: Options of :class:`exoid.signals.ReadOptions`, for every file.

        Returns:
            The recordings; no file is read yet.
        """
        refuse_unknown_options(options)
        read = partial(Recording.from_file, joint_names=joint_names, columns=columns, **options)
        return Recordings(tuple(RecordingFile(Path(path), read) for path in paths))

    def changed(self, change: Callable[[Recording], Recording]) -> Recordings:
        """Change each recording, those on disk when they are read.

        Args:
            change: Function of a recording, which pickle can send to other processes.

        Returns:
            The changed recordings; poses stay as they are.
        """
        changed = (
            RecordingFile(item.path, partial(_read_and_change, item.read, change))
            if isinstance(item, RecordingFile)
            else (change(item) if isinstance(item, Recording) else item)
            for item in self.items
        )
        return replace(self, items=tuple(changed))

    def __len__(self) -> int:
        return len(self.items)

    @overload
    def __getitem__(self, index: int) -> Recording | Poses: ...

    @overload
    def __getitem__(self, index: slice) -> Recordings: ...

    def __getitem__(self, index: int | slice) -> Recording | Poses | Recordings:
        if isinstance(index, slice):
            return replace(self, items=self.items[index])
        item = self.items[index]
        return item.read(item.path) if isinstance(item, RecordingFile) else item

    def __iter__(self) -> Iterator[Recording | Poses]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"Recordings({len(self)})"


def _read_and_change(
    read: Callable[[Path], Recording], change: Callable[[Recording], Recording], path: Path
) -> Recording:
    return change(read(path))


def logs_in(folder: str | os.PathLike[str]) -> list[Path]:
    """List the logs in a folder; numbers in their names are sorted by value."""
    path = Path(folder)

    def by_number(file: Path) -> list[tuple[int, str]]:
        """Sort key by which numbers in names are ordered by value."""
        parts = re.split(r"(\d+)", file.name)
        return [(int(part), "") if k % 2 else (0, part) for k, part in enumerate(parts)]

    try:
        found = [file for file in path.iterdir() if file.is_file() and not file.name.startswith(".")]
    except (FileNotFoundError, NotADirectoryError):
        raise UnreadableInputError("no such folder", where=str(path), remedy="check the path") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        remedy = "check the path and its rights"
        raise UnreadableInputError(f"the folder cannot be read ({reason})", where=str(path), remedy=remedy) from None
    files = sorted((file for file in found if file.suffix.lower().removeprefix(".") in READERS), key=by_number)
    if not files:
        known = ", ".join(f".{ending}" for ending in READERS)
        raise UnreadableInputError(
            "no logs in the folder", where=str(path), remedy=f"give them names that end in {known}"
        )
    return files
