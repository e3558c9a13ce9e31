"""Results whose arrays forbid changes."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np


@dataclass(frozen=True, eq=False)
class ReadOnly:
    """Dataclass whose arrays forbid changes, while those that it was made of stay as they are."""

    def __post_init__(self) -> None:
        """Keep views that are read-only."""
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                object.__setattr__(self, one.name, view)
