"""Readers in a child process, for formats whose libraries can kill the process or fill the memory.

A damaged or malicious file ends the child, not the caller. The child is started by the first such file, which costs the
time of its imports, and serves all later ones. Requests and replies are pickles. Linux bounds the memory of the child,
every system its time.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import IO, Any, TypeVar, cast

from exoid.errors import ExoidError, UnreadableInputError, in_file

from .file_bounds import READER_MEMORY, most_memory, most_seconds, reading, size_on_disk

if sys.platform == "linux":
    import resource

R = TypeVar("R")

START = "import sys; sys.path[:] = sys.argv[1:]; from exoid.tools.reader_process import serve; serve()"
"""Program of the child. It has the import path of the caller, but neither its script nor its modules."""


def read_in_child(reader: Callable[..., R], file: str, **arguments: Any) -> R:  # noqa: ANN401 - what pickle can send
    """Call ``reader(file, **arguments)`` in the child process, with bounds on its memory and its time."""
    try:
        size = size_on_disk(Path(file))
    except (OSError, ValueError):
        size = 0  # the reader has a better message
    with in_file(file), _LOCK:
        child = _child()
        child.ask((_import, reader.__module__, {}), 2**29, 120.0)  # imports do not count as memory of the file
        reply = child.ask((reader, file, arguments), READER_MEMORY + most_memory(size), most_seconds(size))
        if isinstance(reply, ExoidError):
            raise reply
        return cast("R", reply)


class Child:
    """The child process, with the ends of its pipes."""

    def __init__(self) -> None:
        from multiprocessing import spawn  # noqa: PLC0415 - few callers read such files

        try:
            self.process = subprocess.Popen(
                [os.fsdecode(spawn.get_executable()), "-c", START, *sys.path],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={"POLARS_MAX_THREADS": "4", "OPENBLAS_NUM_THREADS": "1", **os.environ},  # threads need memory
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except (OSError, ValueError) as error:
            raise UnreadableInputError(
                f"the process that reads such files cannot be started ({error})",
                remedy="free memory or processes, or convert the log to CSV",
            ) from None
        self.owner = os.getpid()

    def ask(self, request: tuple[Callable[..., Any], str, Mapping[str, Any]], memory: int, seconds: float) -> object:
        """Send a request and wait for its reply; a child that dies or is late ends in one line."""
        requests, replies = cast("IO[bytes]", self.process.stdin), cast("IO[bytes]", self.process.stdout)
        late = threading.Event()

        def end_late() -> None:
            """End a process that takes too long."""
            late.set()
            self.process.kill()

        timer = threading.Timer(seconds, end_late)
        timer.daemon = True
        timer.start()
        reply: object = None
        try:
            requests.write(pickle.dumps((_folder(), memory, request)))
            requests.flush()
            reply = pickle.load(replies)
        except Exception:  # of a pipe that breaks, or of half a pickle
            self.end()
            raise self._death(seconds if late.is_set() else None) from None
        except BaseException:  # Ctrl-C: the rest of the reply would be taken for the next one
            self.end()
            raise
        finally:
            timer.cancel()
        return reply

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with suppress(OSError):  # a request that was not sent
                cast("IO[bytes]", pipe).close()

    def _death(self, seconds: float | None) -> ExoidError:
        """Say how the process died."""
        code = self.process.returncode
        known = -code in set(signal.Signals) if code < 0 else False
        what = f"its reader died ({signal.Signals(-code).name if known else f'status {code}'})"
        if seconds is not None:
            what = f"its reader has not ended within {seconds:.0f} s"
        return UnreadableInputError(
            f"{what}: the file is damaged, or made to crash programs",
            remedy="check where it comes from; write the log again, or as CSV",
        )


_LOCK = threading.Lock()
_CHILDREN: list[Child] = []
"""The child process that this process has started; none or one."""


def _child() -> Child:
    """Find the child process, or start one."""
    if _CHILDREN and (_CHILDREN[0].owner != os.getpid() or _CHILDREN[0].process.poll() is not None):
        _end()
    if not _CHILDREN:
        _CHILDREN.append(Child())
    return _CHILDREN[0]


def _end() -> None:
    """End the child process, unless it belongs to a process of which this one is a fork."""
    while _CHILDREN:
        child = _CHILDREN.pop()
        if child.owner == os.getpid():
            child.end()


atexit.register(_end)


def _folder() -> str | None:
    """Present folder, to which relative paths refer; None if it was removed."""
    try:
        return str(Path.cwd())
    except OSError:
        return None


def _import(module: str) -> None:
    with suppress(Exception):  # the request has a better message
        import_module(module)


def serve() -> None:
    """Answer requests on standard input until it is closed: the loop of the child."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the caller, which ends this process
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # libraries that print do not disturb the replies
    while True:
        try:
            folder, memory, (reader, file, arguments) = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            if folder is not None:
                os.chdir(folder)
            with reading("a log", "check that the file is complete"), limited_memory(memory):
                reply = reader(file, **arguments)
        except ExoidError as error:
            reply = error
        pickle.dump(reply, replies)
        replies.flush()


@contextmanager
def limited_memory(room: int) -> Iterator[None]:
    """Let the system bound the memory that is used in addition, if it can."""
    # Linux bounds data (RLIMIT_DATA), not addresses: allocators and threads of polars reserve far more of these than
    # they use. Containers without /proc do not tell the present size. macOS accepts bounds, and ignores them.
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[5])
    except (OSError, ValueError, IndexError):
        pages = 0
    if sys.platform != "linux" or not pages:
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_DATA)
    limit = pages * resource.getpagesize() + room
    if before[1] != resource.RLIM_INFINITY:
        limit = min(limit, before[1])
    resource.setrlimit(resource.RLIMIT_DATA, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)
