"""Loop of the child process of :mod:`.child`: it reads files on request."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import IO, Any

import numpy as np

from exoid.errors import ExoidError

from .child import Content
from .table import reading

if sys.platform != "win32":
    import resource

REMEDY = "check that the file is complete"

RESIDENT = 1
"""Place of the resident size among the numbers of /proc/self/statm [pages]."""

DATA = 5
"""Place of the size of the data among the numbers of /proc/self/statm."""

MOST_KEPT = 2**28
"""Memory beyond which the process does not serve another request [bytes]."""


def serve() -> None:
    """Answer requests on standard input until it is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the caller, which ends this process
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, sys.stdout.fileno())  # libraries that print do not disturb the replies
    replies.write(b"ready\n")
    replies.flush()
    for line in sys.stdin.buffer:
        if not _answer(json.loads(line), replies):
            break


def _answer(request: Mapping[str, Any], replies: IO[bytes]) -> bool:
    """Answer a request, and tell whether the process serves another one."""
    try:
        if request["folder"] is not None:
            os.chdir(request["folder"])
        module, _, name = request["reader"].partition(":")
        reader = getattr(import_module(module), name)
        with reading(request["file"], "a log", REMEDY), _memory(request["memory"]):
            content: Content = reader(request["file"], **request["arguments"])
            arrays = {name: np.ascontiguousarray(values) for name, values in content.arrays.items()}
    except ExoidError as error:
        content, arrays = Content({}), {}
        reply: dict[str, Any] = {"error": (error.what, error.where, error.remedy, error.command)}
    else:
        reply = {"facts": content.facts, "arrays": [(name, x.dtype.str, x.shape) for name, x in arrays.items()]}
    stays = _stays()
    replies.write(json.dumps({**reply, "stays": stays}).encode() + b"\n")
    for values in arrays.values():
        replies.write(values.tobytes())
    replies.flush()
    return stays


@contextmanager
def _memory(room: int) -> Iterator[None]:
    """Bound the memory that is written in addition; only Linux has such a bound.

    The bound is on data (RLIMIT_DATA), not on addresses: allocators and threads of polars reserve far more of these
    than they use.
    """
    if sys.platform != "linux":
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_DATA)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[DATA])
    limit = pages * resource.getpagesize() + room
    if before[1] != resource.RLIM_INFINITY:
        limit = min(limit, before[1])
    resource.setrlimit(resource.RLIMIT_DATA, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)


def _stays() -> bool:
    """Tell whether the process has not kept much memory; the peak would be that of the caller, which started it."""
    if sys.platform != "linux":
        return True
    resident = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[RESIDENT])
    return resident * resource.getpagesize() < MOST_KEPT
