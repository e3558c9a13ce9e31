"""Readers in a child process, for formats whose libraries can kill the process or fill the memory.

A damaged or malicious file ends the child, not the caller. The child is started by the first such file, which costs the
time of its imports, and serves all later ones. A request is one line of JSON; the reply is another one, and the arrays.
"""

from __future__ import annotations

import atexit
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from io import BufferedReader
from pathlib import Path
from typing import IO, Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from exoid.errors import ExoidError, UnreadableInputError, in_file

from .bounds import READER_MEMORY, most_memory, most_seconds, size_on_disk
from .memory import MOST_KEPT, Watch

START = (
    "import sys; sys.path[:] = sys.argv[2:]; "
    "from exoid.tools.reader_process.child_main import serve; serve(sys.argv[1])"
)
"""Program of the child. It has the import path of the caller, but neither its script nor its modules."""

WATCHED = os.name == "posix" and sys.platform != "linux"
"""Whether the caller looks at the memory of the child; Linux bounds it."""


class Content(NamedTuple):
    """Content of a file, as a reader in the child returns it."""

    arrays: Mapping[str, NDArray[Any]]  # arrays of numbers, text or dates by name
    facts: Mapping[str, Any] = {}  # values of JSON by name


def read_in_child(reader: Callable[..., Content], file: str, beside: int = READER_MEMORY, **arguments: Any) -> Content:  # noqa: ANN401 - JSON
    """Read a file in the child process, with bounds on its memory (where the system has them) and its time."""
    try:
        size = size_on_disk(Path(file))
    except (OSError, ValueError):
        size = 0  # the reader has a better message
    request = {
        "reader": f"{reader.__module__}:{reader.__qualname__}",
        "file": file,
        "arguments": arguments,
        "folder": _folder(),
        "memory": beside + most_memory(size),
    }
    with in_file(file), _LOCK:
        return _child(reader.__module__).ask(request, most_seconds(size))


class Child:
    """The child process, with the ends of its pipes."""

    def __init__(self, module: str) -> None:
        from multiprocessing import spawn  # noqa: PLC0415 - few callers read such files

        try:
            self._process = subprocess.Popen(
                [os.fsdecode(spawn.get_executable()), "-c", START, module, *sys.path],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={"POLARS_MAX_THREADS": "4", **os.environ},  # each needs memory
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except (OSError, ValueError) as error:
            raise UnreadableInputError(
                f"the process that reads such files cannot be started ({error})",
                remedy="free memory or processes, or convert the log to CSV",
            ) from None
        self._requests = cast("IO[bytes]", self._process.stdin)
        self._replies = cast("BufferedReader", self._process.stdout)
        self.owner = os.getpid()
        self.usable = False
        # Longest time in which the child starts and imports its libraries [s]
        with Watch(self._process, 120.0):
            self.usable = bool(self._replies.readline())

    def ask(self, request: Mapping[str, Any], seconds: float) -> Content:
        """Send a request and wait for its reply."""
        whole, self.usable = self.usable, False  # until the reply has been read to its end
        reply: Mapping[str, Any] = {}
        arrays: dict[str, NDArray[Any]] = {}
        watch = Watch(self._process, seconds, MOST_KEPT + int(request["memory"]) if WATCHED else None)
        with watch:
            try:
                self._requests.write(json.dumps(request, default=str).encode() + b"\n")
                self._requests.flush()
                reply = json.loads(self._replies.readline() or b"{}")
                for name, kind, shape in reply.get("arrays", ()):
                    arrays[name] = self._array(np.dtype(kind), shape)
                whole = whole and bool(reply)
            except (OSError, ValueError):
                whole = False
            except BaseException:
                self.end()
                raise
        if watch.killed or not whole:
            raise self._death(seconds, watch.killed)
        self.usable = bool(reply["stays"])
        if "error" in reply:
            what, where, remedy, command = reply["error"]
            raise UnreadableInputError(what, where=where, remedy=remedy, command=command)
        return Content(arrays, reply["facts"])

    def end(self) -> None:
        """End the process."""
        self.usable = False
        self._process.kill()
        self._process.wait()
        for pipe in (self._requests, self._replies):
            with suppress(OSError):  # a request that was not sent
                pipe.close()

    def _array(self, kind: np.dtype[Any], shape: list[int]) -> NDArray[Any]:
        size = kind.itemsize * int(np.prod(shape, dtype=np.int64))
        if not size:
            return np.zeros(shape, kind)
        data = bytearray(size)
        if self._replies.readinto(data) != size:
            raise ValueError("the reply ends early")
        return np.frombuffer(data, kind).reshape(shape)

    def _death(self, seconds: float, killed: str | None) -> ExoidError:
        """Say how the process died."""
        self.end()
        code = self._process.returncode
        if killed == "memory":
            return UnreadableInputError("too large for the memory, or damaged", remedy="check that it is complete")
        if killed == "time":
            what = f"its reader has not ended within {seconds:.0f} s"
        else:
            known = -code in set(signal.Signals) if code < 0 else False
            what = f"its reader died ({signal.Signals(-code).name if known else f'status {code}'})"
        return UnreadableInputError(
            f"{what}: the file is damaged, or made to crash programs",
            remedy="check where it comes from; write the log again, or as CSV",
        )


_LOCK = threading.Lock()
_CHILDREN: list[Child] = []
"""The child process that this process has started; none or one."""


def _child(module: str) -> Child:
    """Find the child process, or start one that imports a module."""
    if _CHILDREN and not (_CHILDREN[0].usable and _CHILDREN[0].owner == os.getpid()):
        _end()
    if not _CHILDREN:
        _CHILDREN.append(Child(module))
    return _CHILDREN[0]


def _end() -> None:
    """End the child process, unless it belongs to a process of which this one is a fork."""
    while _CHILDREN:
        child = _CHILDREN.pop()
        if child.owner == os.getpid():
            child.end()


def _after_fork() -> None:
    """Forget the child process of the parent; another thread may have held the lock."""
    global _LOCK  # noqa: PLW0603
    _LOCK = threading.Lock()
    _CHILDREN.clear()


atexit.register(_end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def _folder() -> str | None:
    """Present folder, to which relative paths refer; None if it was removed."""
    try:
        return str(Path.cwd())
    except OSError:
        return None
