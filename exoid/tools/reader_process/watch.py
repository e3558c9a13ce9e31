"""Watch over a process: it is killed if it takes too long, or more memory than its task needs."""

from __future__ import annotations

import subprocess
import threading
import time
from typing import Literal

from .memory import size_of_process

PERIOD = 0.2
"""Time between two looks at the memory [s]."""


class Watch:
    """Context in which a process is watched."""

    # killed: Reason for which the process was killed; None if it was not.

    def __init__(self, process: subprocess.Popen[bytes], seconds: float, memory: int | None = None) -> None:
        self.killed: Literal["time", "memory"] | None = None
        self._process = process
        self._seconds = seconds
        self._memory = memory
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="exoid reader", daemon=True)

    def _watch(self) -> None:
        until = time.monotonic() + self._seconds
        while not self._over.wait(min(self._left(until), PERIOD) if self._memory is not None else self._left(until)):
            if not self._left(until):
                self._kill("time")
                return
            if self._memory is not None and size_of_process(self._process.pid) > self._memory:
                self._kill("memory")
                return

    def _left(self, until: float) -> float:
        return max(until - time.monotonic(), 0.0)

    def _kill(self, reason: Literal["time", "memory"]) -> None:
        self.killed = reason
        self._process.kill()

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
