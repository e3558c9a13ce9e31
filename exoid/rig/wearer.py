"""Wearer of a leg: a limb that cuffs connect to the leg, passive or with muscles that follow an intended motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.leg_data import refuse_floating_base
from exoid.tools.numbers import checked

from .bodies import limb_of
from .controllers import Reference

IMPEDANCES = ("cuff_stiffness", "cuff_damping", "muscle_stiffness", "muscle_damping")
"""Attributes of a wearer that are numbers for each joint."""


@dataclass(frozen=True, eq=False)
class Wearer:
    """Limb with the joints of the leg, cuffs, and muscles.

    The torque of the wearer on the leg is that of the cuffs, which connect limb (q_l) and leg (q):

        τ_wearer = k (q_l − q) + d (v_l − v)

    The muscles move the limb, and −τ_wearer acts on it. About the intended motion (q_i, v_i, a_i) they make

        τ_muscles = RNEA_limb(q_i, v_i, a_i) + k_m (q_i − q_l) + d_m (v_i − v_l),

    so that the limb alone follows the intention exactly. Numbers for each joint are one for all, (n,), or (n, B) for B
    rigs.

    Attributes:
        limb: Geometry of the leg with the rigid-body parameters of the limb, see :func:`exoid.rig.limb_of`. It has no
            friction.
        cuff_stiffness: Stiffness k of the cuffs [N·m/rad]; like all default impedances an assumption.
        cuff_damping: Damping d of the cuffs [N·m·s/rad].
        muscle_stiffness: Stiffness k_m of the muscles [N·m/rad]; 0 for a passive limb.
        muscle_damping: Damping d_m of the muscles, or of the joints of a passive limb [N·m·s/rad].
        intention: Intended motion of one rig or B; None for a passive limb, which hangs in the leg.
        feedforward: Whether the muscles also make the torque that the limb alone needs for the intended motion; then
            the intention has accelerations.

    Raises:
        ExoidError: The base of the limb floats, a number is negative, not finite or for other joints, or only one of
            intention and muscles is given.
    """

    limb: Leg
    cuff_stiffness: ArrayLike = 1000.0
    cuff_damping: ArrayLike = 30.0
    muscle_stiffness: ArrayLike = 0.0
    muscle_damping: ArrayLike = 0.0
    intention: Reference | None = None
    feedforward: bool = True

    def __post_init__(self) -> None:
        """Check base, numbers and intention."""
        if not isinstance(self.limb, Leg):
            what = f"a limb of type {type(self.limb).__name__}"
            raise BadArgumentError(what, remedy="give a Leg, or use Wearer.build(leg, height, mass)")
        refuse_floating_base(self.limb, "a wearer")
        n = len(self.limb.joint_names)
        for name in IMPEDANCES:
            value = checked(getattr(self, name), f"{name} of the wearer", least=0.0, ndim=2)
            if value.ndim > 0 and len(value) != n:
                remedy = f"give one number, or one for each of {n}"
                raise BadArgumentError(f"{name} of {len(value)} joints", remedy=remedy)
            object.__setattr__(self, name, value[:, None] if value.ndim == 1 else value)
        if self.intention is None and np.any(self.muscle_stiffness):
            what = "muscles with stiffness but without intention"
            raise BadArgumentError(what, remedy="give an intention, or muscle_stiffness=0")
        active = self.feedforward or np.any(self.muscle_stiffness) or np.any(self.muscle_damping)
        if self.intention is not None and not active:
            raise BadArgumentError("an intention without muscles", remedy="give muscle_stiffness, or intention=None")

    @classmethod
    def build(
        cls,
        leg: Leg,
        height: float = 1.75,
        mass: float = 70.0,
        *,
        roles: Mapping[str, str] | None = None,
        intention: Reference | None = None,
        cuff_stiffness: ArrayLike = 1000.0,
        cuff_damping: ArrayLike = 30.0,
        muscle_stiffness: ArrayLike | None = None,
        muscle_damping: ArrayLike | None = None,
        feedforward: bool = True,
    ) -> Wearer:
        """Make a wearer by anthropometry (Winter 2009).

        Args:
            leg: Planar leg with joints hip, knee and ankle, or some of them.
            height: Height of the wearer [m].
            mass: Mass of the wearer [kg].
            roles: "hip", "knee" or "ankle" for each joint that has another name.
            intention: Intended motion; None for a passive wearer.
            cuff_stiffness: See the class.
            cuff_damping: See the class.
            muscle_stiffness: See the class; None for 100 N·m/rad with an intention and 0 without.
            muscle_damping: See the class; None for 5 N·m·s/rad with an intention and 0 without.
            feedforward: See the class.

        Returns:
            The wearer.

        Raises:
            ExoidError: A joint has another role, height or mass are not those of a person, or see the class.

        Example:
            >>> import exoid
            >>> Wearer.build(exoid.load_leg("cuhk"), 1.70, 65.0)
            Wearer(passive, limb of cuhk.urdf: left_hip, left_knee)
        """
        active = intention is not None
        return cls(
            limb_of(leg, height, mass, roles),
            cuff_stiffness,
            cuff_damping,
            100.0 * active if muscle_stiffness is None else muscle_stiffness,
            5.0 * active if muscle_damping is None else muscle_damping,
            intention,
            feedforward,
        )

    def __repr__(self) -> str:
        """Say whether the wearer is active, and name the joints."""
        kind = "passive" if self.intention is None else "active"
        return f"Wearer({kind}, limb of {self.limb.description.name}: {', '.join(self.limb.joint_names)})"
