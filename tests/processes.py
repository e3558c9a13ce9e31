"""Programs in processes of their own, and a process whose disk is full."""

import signal
import subprocess
import sys
from contextlib import contextmanager

import pytest


def run(*command, code=0, **options):
    """Run a command that ends with an exit status; return what it printed, of a failure on standard error."""
    words, given = [str(word) for word in command], {"timeout": 600, "encoding": "utf-8", **options}
    done = subprocess.run(words, capture_output=True, text=True, check=False, **given)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stderr if code else done.stdout


@contextmanager
def full_disk():
    """A limit on the size of files stands for the disk: writing fails midway, with an error of the system."""
    resource = pytest.importorskip("resource")
    old, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024, old[1]))
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
        signal.signal(signal.SIGXFSZ, handler)


def run_python(program, *arguments, **options):
    """Run a program in a fresh interpreter."""
    return run(sys.executable, "-c", program, *arguments, **options)
