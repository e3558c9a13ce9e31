"""Memory of a recursive estimator: state, stream, and samples that wait."""

from __future__ import annotations

from typing import NamedTuple

from .intake import Intake
from .state import State


class Memory(NamedTuple):
    """All that a recursive estimator has to remember, which its file contains."""

    state: State  # what it knows
    intake: Intake  # what it knows of the stream
    pending: tuple[tuple[float, ...], ...] = ()  # samples that wait for their block to be complete, (5 n,) each
