"""Data of a leg: a Pinocchio model, its geometry, its base parameters, and the regressor that they multiply."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError

from .base_kinematics import BaseKinematics
from .closure import Closure, TreeMotion
from .description import Description
from .floating_base import FREE_ROWS, free_flyer_model, planar_coordinates
from .model import dynamic_parameters, position_limits
from .reduction import Plane
from .reduction.planar import PlanarChain
from .reduction.planar_machine import PLANAR_ROWS, SIDES, Limb, PlanarMachine
from .reduction.reduction import Reduction
from .reduction.tree import Tree
from .reduction.tree_regressor import fill_reduced_regressor
from .rewriting import RAIL
from .torso import MovingBase, TorsoMotion, base_kinematics

Base = Literal["fixed", "moving", "floating", "x", "y", "z"]
"""Whether the base of the leg stands, moves in space, floats, or moves along one axis, that of a rail.

Force and moment on a base that floats have rows of their own. A rail is a joint before the others, of a leg whose base
is "fixed".
"""


Contact = Literal["flat", "edge", "point"]
"""What of a link a contact holds: the whole sole, a line across it such as heel or toe, or the origin of the link."""

LARGEST_BALL = 0.2
"""Largest radius of a ball foot [m]; a larger one is in mm."""

ROLES = ("hip", "knee", "ankle")
"""Joints of a person's leg, which gait and anthropometry know by these names."""


class JointLimits(NamedTuple):
    """Limits of each joint in the URDF, (n,) each; infinite where it has none."""

    lower: FloatArray  # smallest angle [rad]
    upper: FloatArray  # largest angle [rad]
    velocity: FloatArray  # largest speed [rad/s]
    effort: FloatArray  # largest torque [N·m]


@dataclass(frozen=True, eq=False, repr=False)
class LegData:
    """Model, geometry, parameters and regressor of a leg; see :class:`exoid.Leg`.

    Attributes:
        description: The URDF.
        locked: Positions of joints that do not move [rad].
        cumulative: Whether J of a segment contains the J below it (doc. 1) or not (doc. 2).
        model: Pinocchio model of the moving joints; do not change it.
        reduction: Reduction of link parameters to :attr:`parameters`.
        machine: Planar geometry of the limbs; None if the leg is not planar.
        base: "moving" if the parameters are those that torques on a base that moves in space depend on: numerical ones,
            more than on a fixed base. "floating" if rows of the base come before those of the joints.
        contacts: Kind of contact of links that do not rest flat; of a ball its radius [m].
        closure: Loop equations of a machine with closed loops, whose joints are the independent ones; None without.
    """

    description: Description
    model: pin.Model
    reduction: Reduction
    machine: PlanarMachine | None
    locked: Mapping[str, float] = field(default_factory=dict)
    cumulative: bool = True
    base: Base = "fixed"
    contacts: Mapping[str, Contact | float] = field(default_factory=dict)
    closure: Closure | None = None

    @property
    def hip(self) -> FloatArray:
        """Origin of the first joint in the axes of the root link [m], (3,)."""
        return np.array(self.model.jointPlacements[1].translation)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints in the URDF, from the torso outwards."""
        return self.tree_joint_names if self.closure is None else self.closure.joint_names

    @cached_property
    def tree_joint_names(self) -> tuple[str, ...]:
        """Names of all moving joints, those that follow from closed loops included."""
        return tuple(self.model.names)[1:]

    @property
    def limbs(self) -> tuple[Limb, ...]:
        """Planar chains of the leg; () if it is not planar."""
        return () if self.machine is None else self.machine.limbs

    @property
    def chain(self) -> PlanarChain | None:
        """Planar geometry of a single limb on a base that does not float; None for all other legs."""
        return self.limbs[0].chain if len(self.limbs) == 1 and self.base == "fixed" else None

    @property
    def plane(self) -> Plane:
        """Plane of motion in the axes of the root link; x and z of these axes for a leg that is not planar."""
        return self.limbs[0].chain.plane if self.limbs else Plane(*np.eye(3))

    @property
    def base_rows(self) -> int:
        """Number of rows of a floating base, before those of the joints: 3 in a plane, otherwise 6; 0 without one."""
        return 0 if self.base != "floating" else len(FREE_ROWS if self.machine is None else PLANAR_ROWS)

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names of the rows: forces and moments on a floating base, and the joints.

        The rows of a planar base are the force forward and up [N], in axes that turn with the torso, and the moment
        about the hip [N·m], positive like the pitch. Others are force and moment about the origin of the root link.
        """
        rows = FREE_ROWS if self.machine is None else PLANAR_ROWS
        return (*rows, *self.joint_names) if self.base == "floating" else self.joint_names

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Joint names without ``left_`` or ``right_``, which occur in the names of parameters."""
        return without_side(self.joint_names)

    def contact_kind(self, link: str) -> Contact:
        """Tell how a link rests on the ground.

        Args:
            link: Name of a link in the URDF.

        Returns:
            Its kind in :attr:`contacts`; "point" for a ball, "flat" for all others.
        """
        kind = self.contacts.get(link, "flat")
        return kind if isinstance(kind, str) else "point"

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links that the joints carry."""
        return tuple(self.description.child_links[joint] for joint in self.joint_names)

    @property
    def link_labels(self) -> tuple[str, ...]:
        """Link names without ``left_`` or ``right_``."""
        return without_side(self.link_names)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Links whose inertia is in the equation: those that joints carry, behind the root link if the base floats."""
        carried = tuple(self.description.child_links[joint] for joint in self.tree_joint_names)
        return (self.description.root_link,) * (self.base == "floating") + carried

    @property
    def link_parameters(self) -> FloatArray:
        """Ten parameters π of each of :attr:`bodies` about its joint, or the origin of the root link, (10 k,)."""
        return dynamic_parameters(self.model, root=self.base == "floating")

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of every array of parameters."""
        return self.reduction.names

    @property
    def parameter_units(self) -> tuple[str, ...]:
        """Units of the parameters."""
        return self.reduction.units

    @cached_property
    def parameters(self) -> FloatArray:
        """Values of the parameters in SI units, (p,)."""
        values = self.reduction.parameters(self.link_parameters)
        values.flags.writeable = False
        return values

    @property
    def limits(self) -> JointLimits:
        """Limits of the joints."""
        model = self.model
        chosen = slice(None) if self.closure is None else self.closure.independent
        speed, effort = (np.where(limit > 0.0, limit, np.inf) for limit in (model.velocityLimit, model.effortLimit))
        lower, upper = position_limits(model)[:, chosen]
        return JointLimits(lower, upper, speed[chosen], effort[chosen])

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: MovingBase | None = None) -> FloatArray:
        """Form the regressor W of the parameters: τ = W(q, v, a) β. Rows of a floating base come before the joints.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso or of the base in space, of which a planar leg takes the part within its plane;
                None if it is upright and still.

        Returns:
            W, (N, base_rows + n, p), each column contiguous in memory.

        Raises:
            ExoidError: Shapes do not fit, or the base of a leg moves that is neither a planar chain nor made for that.
        """
        q, v, a = self.samples(q, v, a)
        out = np.zeros((len(self.parameter_names), len(self.row_names), len(q)))
        self.fill_regressor(q, v, a, out, torso)
        return out.transpose(2, 1, 0)

    def fill_regressor(
        self, q: FloatArray, v: FloatArray, a: FloatArray, out: FloatArray, torso: MovingBase | None = None
    ) -> None:
        """Write the regressor into an array.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            out: Receives Wᵀ, zeroed, (p, base_rows + n, N).
            torso: Motion of the torso, or of the base; see :meth:`regressor`.

        Raises:
            ExoidError: The base of a leg moves that is neither a planar chain nor made for that.
        """
        if self.machine is not None:
            within = None
            if isinstance(torso, TorsoMotion) and self.base != "floating":
                within = torso.samples(len(q))
            elif torso is not None:  # rows of a floating base are in axes that turn with it
                within = self._base(torso, len(q)).in_plane(self.plane, self.hip)
            self.machine.fill_regressor(q, v, a, out, cumulative=self.cumulative, torso=within)
        elif torso is None or self.base != "fixed":
            base = None if torso is None else self._base(torso, len(q)).spatial()
            moved = self.tree_motion(q, v, a)
            fill_reduced_regressor(self.reduction, self._tree, moved.q, moved.v, moved.a, out, base, moved.G)
        else:
            if self.description.root_link == RAIL:
                raise NotSupportedError(
                    "the base of this leg moves along its rail alone, and a motion of the base in space was given",
                    where=self.description.name,
                    remedy='leave the base\'s gyroscope and accelerometer out, or make the leg with base="floating"',
                )
            raise NotSupportedError(
                "a moving base needs more parameters unless the leg is a planar chain",
                where=self.description.name,
                remedy='make the leg with Leg.from_urdf(..., base="moving")',
                command="give --moving-base",
            )

    def tree_motion(self, q: FloatArray, v: FloatArray | None = None, a: FloatArray | None = None) -> TreeMotion:
        """Find the motion of all joints, those that follow from closed loops included.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n); None at rest.
            a: Joint accelerations [rad/s²], (N, n); None for none.

        Returns:
            Motion of :attr:`tree_joint_names`.

        Raises:
            ExoidError: The loops do not close at a sample.
        """
        still = np.zeros_like(q)
        v, a = still if v is None else v, still if a is None else a
        return TreeMotion(q, v, a) if self.closure is None else self.closure.motion(q, v, a)

    def samples(self, *arrays: ArrayLike) -> tuple[FloatArray, ...]:
        """Check that arrays have the same shape (N, n).

        Args:
            *arrays: Arrays, (N, n); a single sample (n,) counts as N = 1.

        Returns:
            The arrays in float64.

        Raises:
            ExoidError: Shapes differ, or do not fit the number of joints.
        """
        try:
            checked = tuple(np.atleast_2d(np.asarray(x, dtype=np.float64)) for x in arrays)
        except (TypeError, ValueError) as error:
            what = f"not an array of numbers ({error})"
            raise BadArgumentError(what, remedy="pass numbers, samples first") from error
        n = len(self.joint_names)
        if any(x.shape != checked[0].shape or x.shape[1] != n or x.ndim != 2 for x in checked):
            raise BadArgumentError(
                f"arrays of shapes {', '.join(str(x.shape) for x in checked)} do not fit a leg of {n} joints",
                remedy=f"pass (N, {n}) arrays: samples first, then {', '.join(self.joint_names)}",
            )
        return checked

    def __repr__(self) -> str:
        """Write the URDF, the joints and the parameters."""
        kind = ("planar" if self.limbs else "numeric") + ", floating base" * (self.base == "floating")
        kind += ", closed loops" * (self.closure is not None)
        names = ", ".join(self.parameter_names)
        return f"Leg({self.description.name!r}, joints={self.joint_names}, {kind}: {names})"

    @cached_property
    def _free(self) -> pin.Model:
        return free_flyer_model(self.model)

    @cached_property
    def _tree(self) -> Tree:
        return Tree.from_model(self._free if self.base == "floating" else self.model)

    @cached_property
    def _base_coordinates(self) -> FloatArray:
        """Twist of the root link per unit of each base coordinate, (6, base_rows)."""
        if self.base != "floating":
            return np.zeros((6, 0))
        return np.eye(6) if self.machine is None else planar_coordinates(self.plane, self.hip)

    def _base(self, torso: MovingBase | None, count: int) -> BaseKinematics:
        if torso is None:  # upright and still
            still = np.zeros((count, 3))
            return BaseKinematics(still, still, np.tile(-self.model.gravity.linear, (count, 1)))
        return base_kinematics(torso, count, self.plane, self.hip)


def without_side(names: Sequence[str]) -> tuple[str, ...]:
    """Leave out ``left_`` or ``right_`` where all names begin with it."""
    for side in SIDES:
        if all(name.startswith(side) and name != side for name in names):
            return tuple(name.removeprefix(side) for name in names)
    return tuple(names)


def refuse_floating_base(leg: LegData, what: str) -> None:
    """Refuse a leg whose base floats."""
    if leg.base == "floating":
        message = f"{what} needs a base that is held, and that of this leg floats"
        raise NotSupportedError(message, where=leg.description.name, remedy='make the leg with base="fixed"')


def joint_roles(leg: LegData, roles: Mapping[str, str]) -> tuple[str, ...]:
    """Name the role of each joint: that which was declared, else its own label."""
    unknown = [joint for joint in roles if joint not in (*leg.joint_names, *leg.joint_labels)]
    if unknown or any(role not in ROLES for role in roles.values()):
        declared = ", ".join(f"{joint}={role}" for joint, role in roles.items())
        raise BadArgumentError(
            f"roles {declared} of the joints {', '.join(leg.joint_names)}",
            where=leg.description.name,
            remedy=f"give each joint one of {', '.join(ROLES)}",
        )
    names = zip(leg.joint_names, leg.joint_labels, strict=True)
    found = tuple(roles.get(name, roles.get(label, label)) for name, label in names)
    if roles and len(set(found)) < len(found):
        raise BadArgumentError(
            f"two joints are one of {', '.join(found)}", where=leg.description.name, remedy="give each another role"
        )
    return found
