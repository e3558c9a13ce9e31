"""Control laws as C99: each law says here which template and numbers it is in C; :mod:`exoid.codegen.laws` writes them."""

from . import computed_torque, feedforward_pd, gravity_friction_pd, limited, lqr, pd
from .forms import law_in_c, register_law_in_c
from .leg import leg_in_c
from .write import c_source, write_c

__all__ = ["c_source", "law_in_c", "leg_in_c", "register_law_in_c", "write_c"]
