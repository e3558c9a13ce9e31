"""Links on the ground: which rest, what their wrenches leave of the equation, and where the base is."""

from .sliding import refuse_dead_switches, refuse_rolling_feet
from .standing_base import level_rotation
from .stretches import Split, split

__all__ = ["Split", "level_rotation", "refuse_dead_switches", "refuse_rolling_feet", "split"]
