"""Readers that misbehave, for the child process that reads files."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from exoid.errors import ExoidError


def echo(file, **arguments):
    print("libraries may print")
    return {"file": file, "folder": str(Path.cwd()), "pid": os.getpid(), **arguments}


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
