"""Bounds on the memory of the process that reads files: by the system, and by its caller, which looks at its size.

On Linux the system bounds data (RLIMIT_DATA), not addresses: allocators and threads of polars reserve far more of these
than they use. Other systems of the POSIX family have a bound on addresses (RLIMIT_AS), which macOS accepts and ignores.
So elsewhere than on Linux the caller also looks at the resident size, a few times a second. Where no size is known (a
container without /proc and ps), only the time is bounded.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import resource

STATM = Path("/proc/self/statm")
"""File in which Linux tells the sizes of this process [pages]."""

DATA = 5
"""Place of the size of the data among the numbers of /proc/self/statm."""

MOST_KEPT = 2**28
"""Memory beyond which the process does not serve another request [bytes]."""


@contextmanager
def limited_memory(room: int) -> Iterator[None]:
    """Let the system bound the memory that is used in addition, if it can."""
    if sys.platform == "win32":
        yield
        return
    if sys.platform == "linux":
        kind, present = resource.RLIMIT_DATA, _pages(DATA) * resource.getpagesize()
    else:
        kind, present = resource.RLIMIT_AS, size_of_process(None, "vsz")
    before = resource.getrlimit(kind)
    limit = present + room
    if before[1] != resource.RLIM_INFINITY:
        limit = min(limit, before[1])
    with suppress(OSError, ValueError):  # a system that has the name of the bound only
        if present:
            resource.setrlimit(kind, (limit, before[1]))
    try:
        yield
    finally:
        with suppress(OSError, ValueError):
            resource.setrlimit(kind, before)


def keeps_little() -> bool:
    """Tell whether this process has not kept much memory; the peak would be that of the caller, which started it."""
    if sys.platform != "linux":
        return True  # its caller looks at its size
    # Place of the resident size among the numbers of /proc/self/statm
    return _pages(1) * resource.getpagesize() < MOST_KEPT


def size_of_process(pid: int | None, kind: str = "rss") -> int:
    """Ask ps for the size of a process."""
    command = ["ps", "-o", f"{kind}=", "-p", str(os.getpid() if pid is None else pid)]
    try:
        # Longest time for which ps is waited for [s]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=5.0)
        return 1024 * int(done.stdout)
    except (OSError, ValueError, subprocess.SubprocessError):
        return 0


def _pages(place: int) -> int:
    """Read a size of this process; 0 where /proc is not mounted, as in some containers."""
    try:
        return int(STATM.read_text(encoding="ascii").split()[place])
    except (OSError, ValueError, IndexError):
        return 0
