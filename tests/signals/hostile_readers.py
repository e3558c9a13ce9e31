"""Readers that misbehave, for the child process that reads files."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np

from exoid.errors import ExoidError
from exoid.tools.reader_process.child import Content


def echo(file, **arguments):
    print("libraries may print")
    kinds = {"f": np.arange(6.0).reshape(2, 3), "u": np.array(["hip", "knie ü"]), "t": np.array([1], "M8[ns]")}
    kinds |= {"none": np.zeros((0, 3)), "wide": np.zeros((5, 0)), "big": np.arange(3, dtype=">i2")}
    return Content(kinds, {"file": file, "folder": str(Path.cwd()), "pid": os.getpid(), **arguments})


def die(file, number):
    os.kill(os.getpid(), number)


def leave(file):
    os._exit(3)


def refuse(file):
    raise ExoidError("bad", where=file, remedy="mend it")


def fail(file):
    raise LookupError("any\nother")


def fill_memory(file):
    kept = []
    while True:
        kept.append(np.ones(2**20))


def hang(file):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(1000.0)


def keep_much(file):
    """Take 200 MB, and keep them."""
    kept = np.ones(25 * 2**20)
    time.sleep(1000.0)
    return Content({"kept": kept})
