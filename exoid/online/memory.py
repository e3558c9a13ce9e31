"""Memory of a recursive estimator: state, stream, and samples that wait."""

from __future__ import annotations

from typing import NamedTuple

from .intake import Intake
from .state import State


class Memory(NamedTuple):
    """All that a recursive estimator has to remember, which its file contains.

    Attributes:
        state: What it knows.
        intake: What it knows of the stream.
        pending: Samples that wait for their block to be complete, (5 n,) each.
    """

    state: State
    intake: Intake
    pending: tuple[tuple[float, ...], ...] = ()
