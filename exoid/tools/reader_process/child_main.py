"""Loop of the child process of :mod:`.child`: it reads files on request."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Mapping
from contextlib import suppress
from importlib import import_module
from typing import IO, Any

import numpy as np

from exoid.errors import ExoidError

from .bounds import reading
from .child import Content
from .memory import keeps_little, limited_memory

REMEDY = "check that the file is complete"


def serve(module: str) -> None:
    """Answer requests on standard input until it is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the caller, which ends this process
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, sys.stdout.fileno())  # libraries that print do not disturb the replies
    with suppress(Exception):  # the request has a better message
        import_module(module)
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
        with reading("a log", REMEDY), limited_memory(request["memory"]):
            content: Content = reader(request["file"], **request["arguments"])
            arrays = {name: np.ascontiguousarray(values) for name, values in content.arrays.items()}
    except ExoidError as error:
        content, arrays = Content({}), {}
        reply: dict[str, Any] = {"error": (error.what, error.where, error.remedy, error.command)}
    else:
        reply = {"facts": content.facts, "arrays": [(name, x.dtype.str, x.shape) for name, x in arrays.items()]}
    stays = keeps_little()
    replies.write(json.dumps({**reply, "stays": stays}).encode() + b"\n")
    for values in arrays.values():
        replies.write(values.tobytes())
    replies.flush()
    return stays
