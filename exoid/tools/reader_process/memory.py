"""Bounds on the memory of the process that reads files: by the system, and by its caller, which looks at its size.

On Linux the system bounds data (RLIMIT_DATA), not addresses: allocators and threads of polars reserve far more of these
than they use. On other systems of the POSIX family, of which macOS accepts bounds and ignores them, the caller looks at
the resident size a few times a second. Where no size is known (a container without /proc and ps), only the time is
bounded.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

if sys.platform == "linux":
    import resource


STATM = Path("/proc/self/statm")
"""File in which Linux tells the sizes of this process [pages]."""

MOST_KEPT = 2**28
"""Memory beyond which the process does not serve another request [bytes]."""


@contextmanager
def limited_memory(room: int) -> Iterator[None]:
    """Let the system bound the memory that is used in addition, if it can."""
    if sys.platform != "linux":
        yield
        return
    present, before = _pages(5) * resource.getpagesize(), resource.getrlimit(resource.RLIMIT_DATA)
    limit = present + room
    if before[1] != resource.RLIM_INFINITY:
        limit = min(limit, before[1])
    if present:
        resource.setrlimit(resource.RLIMIT_DATA, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)


def keeps_little() -> bool:
    """Tell whether this process has not kept much memory; the peak would be that of the caller, which started it."""
    if sys.platform != "linux":
        return True  # its caller looks at its size
    return _pages(1) * resource.getpagesize() < MOST_KEPT


def size_of_process(pid: int) -> int:
    """Ask ps for the resident size of a process."""
    command = ["ps", "-o", "rss=", "-p", str(pid)]
    try:
        # Longest time for which ps is waited for [s]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=5.0)
        return 1024 * int(done.stdout)
    except (OSError, ValueError, subprocess.SubprocessError):
        return 0


def _pages(place: int) -> int:
    """Read a size of this process: 1 is resident, 5 its data. 0 where /proc is not mounted, as in some containers."""
    try:
        return int(STATM.read_text(encoding="ascii").split()[place])
    except (OSError, ValueError, IndexError):
        return 0


PERIOD = 0.2
"""Time between two looks at the memory [s]."""


class Watch:
    """Context in which a process is watched."""

    def __init__(self, process: subprocess.Popen[bytes], seconds: float, memory: int | None = None) -> None:
        self.killed: Literal["time", "memory"] | None = None  # why the process was killed, if it was
        self._process = process
        self._seconds = seconds
        self._memory = memory
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="exoid reader", daemon=True)

    def _watch(self) -> None:
        left, until = self._seconds, time.monotonic() + self._seconds
        while not self._over.wait(left if self._memory is None else min(left, PERIOD)):
            left = max(until - time.monotonic(), 0.0)
            if not left or (self._memory is not None and size_of_process(self._process.pid) > self._memory):
                self.killed = "memory" if left else "time"
                self._process.kill()
                return

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
