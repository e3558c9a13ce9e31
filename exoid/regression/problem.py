"""What can be fitted: the rows of one leg, or those of several together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid.identification.problem import Block, Kind

from .least_squares import Solution
from .r_factor import Triangle

T = TypeVar("T")


class Reduced(Protocol):
    """A problem reduced to triangles, which is all that least squares asks for."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the parameters."""
        ...

    @property
    def triangles(self) -> Sequence[Triangle]:
        """Triangle of the rows of each joint, in motion and at rest."""
        ...

    def solve(self, triangle: Triangle) -> Solution:
        """Solve for rows, with what is known beside them."""
        ...


class Stacked(Reduced, Protocol):
    """A problem whose rows can be gone over again, joint by joint."""

    @property
    def columns(self) -> Sequence[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices, in the order of the columns of its rows."""
        ...

    def weight_index(self, kind: Kind, joint: int) -> int:
        """Place among the triangles of the one that holds the rows of a kind and joint."""
        ...

    def blocks(self, *, thinned: bool = False) -> Iterator[Block]:
        """Go over the rows, recording by recording, each in order of time."""
        ...

    def gather(self, work: Callable[[Iterable[Block]], T]) -> Iterator[T]:
        """Let work go over the thinned rows of each recording, wherever they are, and bring back what it finds."""
        ...
