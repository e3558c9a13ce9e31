"""Leg: a URDF, the joints that move, and its base parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args

import numpy as np
import pinocchio as pin

from ._typing import ArrayLike, FloatArray
from .base_kinematics import BaseKinematics
from .description import Description, read_description
from .dh import Convention, DHBody, DHRow, describe_dh
from .dynamics import (
    SegmentPlacements,
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    inverse_dynamics_on_base,
    mass_matrix,
    segment_placements,
)
from .errors import ExoidError
from .floating_base import (
    FREE_ROWS,
    floating_mass_matrix,
    free_flyer_model,
    planar_coordinates,
    project_columns,
    rest,
)
from .link_frames import link_frame, planar_directions
from .model import build_model, dynamic_parameters, with_dynamic_parameters
from .reduction import (
    PLANAR_ROWS,
    Limb,
    PlanarChain,
    PlanarMachine,
    Plane,
    Reduction,
    TorsoSamples,
    Tree,
    documented,
    documented_machine,
    fill_reduced_regressor,
    fill_regressor,
    numeric,
    tree_jacobian,
)
from .torso import (
    TORSO_JOINTS,
    MovingBase,
    TorsoMotion,
    base_kinematics,
    moving_torso_model,
    torso_coordinates,
    torso_samples,
)

SIDES = ("left_", "right_")

Base = Literal["fixed", "moving", "floating"]
"""Whether the base of the leg stands, moves in space, or floats: then force and moment on it have rows of their own."""


class JointLimits(NamedTuple):
    """Limits of each joint in the URDF, (n,) each; infinite where it has none.

    Attributes:
        lower: Smallest angle [rad].
        upper: Largest angle [rad].
        velocity: Largest speed [rad/s].
        effort: Largest torque [N·m].
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    effort: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class Leg:
    """Rigid-body model of one leg, or of any other robot: a Pinocchio model and its base parameters.

    For a planar chain the parameters are (X, Y, J) of each segment, as in the documents. For any other robot they are
    numerical base parameters. For every motion, ``regressor(q, v, a) @ parameters == inverse_dynamics(q, v, a)``.

    Make a leg with :func:`exoid.load_leg` or :meth:`Leg.from_urdf`.

    Attributes:
        description: The URDF.
        locked: Positions of joints that do not move [rad].
        cumulative: Whether J of a segment contains the J below it (doc. 1) or not (doc. 2).
        model: Pinocchio model of the moving joints; do not change it.
        chain: Planar geometry; None if the leg is not a planar chain.
        reduction: Reduction of link parameters to :attr:`parameters`.
        base: "moving" if the parameters are those that torques on a base that moves in space depend on: numerical ones,
            more than on a fixed base. "floating" if rows of the base come before those of the joints.
        machine: Planar geometry of several limbs, or of what has a floating base; None for all other legs.
    """

    description: Description
    model: pin.Model
    reduction: Reduction
    chain: PlanarChain | None
    locked: Mapping[str, float] = field(default_factory=dict)
    cumulative: bool = True
    base: Base = "fixed"
    machine: PlanarMachine | None = None

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        joints: Sequence[str] | None = None,
        *,
        locked: Mapping[str, float] | None = None,
        cumulative: bool = True,
        base: Base = "fixed",
    ) -> Leg:
        """Read a leg from a URDF file.

        Args:
            path: The URDF.
            joints: Joints that move, from the torso outwards; all others are locked. None for every joint of one
                degree of freedom.
            locked: Positions of other joints [rad or m]; zero if not given.
            cumulative: Whether J of a segment contains the J below it (doc. 1) or not (doc. 2).
            base: "moving" for the parameters of a leg whose base moves in space. A planar chain takes motions of its
                base within its plane without it. "floating" adds rows of the base, and the parameters of the root link.

        Returns:
            The leg.

        Raises:
            ExoidError: The URDF cannot be read or used, or a joint is missing.

        Example:
            >>> leg = Leg.from_urdf("my_leg.urdf", joints=("hip", "knee"))  # doctest: +SKIP
        """
        return cls.from_description(read_description(path), joints, locked=locked, cumulative=cumulative, base=base)

    @classmethod
    def from_dh(
        cls,
        table: Sequence[DHRow] | ArrayLike,
        convention: Convention,
        joint_names: Sequence[str] | None = None,
        *,
        bodies: Sequence[DHBody] | None = None,
        base_rpy: Sequence[float] = (0.0, 0.0, 0.0),
        locked: Mapping[str, float] | None = None,
        cumulative: bool = True,
        name: str = "dh",
    ) -> Leg:
        """Make a leg of a Denavit-Hartenberg table, for a robot without a URDF.

        Identification uses only the geometry, so that inertias may be left out. The tool's frame is the last one.

        Args:
            table: Rows (a, α, d, offset of θ) of revolute joints in m and rad, (n, 4), such as :class:`exoid.dh.DHRow`;
                (n, 3) without the offset.
            convention: "standard" (Rz Tz Tx Rx) or "modified" (Rx Tx Rz Tz, Craig).
            joint_names: Names of the n joints; None for joint1, joint2, ….
            bodies: Inertia of each link in its frame; None for a unit mass at the origin of each frame.
            base_rpy: Roll, pitch and yaw [rad] of frame 0 in the base, whose z axis points up.
            locked: Positions of joints that do not move [rad].
            cumulative: See :meth:`from_urdf`.
            name: Name of the robot.

        Returns:
            The leg.

        Raises:
            ExoidError: The table has other numbers than a DH table, or names or bodies do not fit it.

        Example:
            >>> rows = [(0.0, np.pi / 2, 0.2), (0.4, 0.0, 0.0), (0.3, 0.0, 0.0)]
            >>> Leg.from_dh(rows, "standard", ("yaw", "shoulder", "elbow")).joint_names
            ('yaw', 'shoulder', 'elbow')
        """
        description = describe_dh(table, convention, joint_names, bodies=bodies, base_rpy=base_rpy, name=name)
        return cls.from_description(description, locked=locked, cumulative=cumulative)

    @classmethod
    def from_description(
        cls,
        description: Description,
        joints: Sequence[str] | None = None,
        *,
        locked: Mapping[str, float] | None = None,
        cumulative: bool = True,
        base: Base = "fixed",
    ) -> Leg:
        """Build a leg from a description in memory.

        Args:
            description: The URDF.
            joints: See :meth:`from_urdf`.
            locked: See :meth:`from_urdf`.
            cumulative: See :meth:`from_urdf`.
            base: See :meth:`from_urdf`.

        Returns:
            The leg.

        Raises:
            ExoidError: The URDF cannot be used, or a joint is missing.
        """
        if base not in get_args(Base):
            raise ExoidError(f"base is {base!r}", remedy='pass base="fixed", base="moving" or base="floating"')
        locked = MappingProxyType(dict(locked or {}))
        model = build_model(description, joints, locked)
        chain = PlanarChain.from_model(model) if base == "fixed" else None
        floating = base == "floating"
        machine = PlanarMachine.from_model(model, floating=floating) if chain is None and base != "moving" else None
        if chain is not None:
            reduction = documented(chain, cumulative=cumulative)
        elif machine is not None:
            reduction = documented_machine(machine, model.jointPlacements[1].translation, cumulative=cumulative)
        else:
            links = _without_side([description.child_links[name] for name in list(model.names)[1:]])
            if floating:
                reduction = numeric(free_flyer_model(model), (description.root_link, *links))
            else:
                reduction = numeric(model, links, moving_base=base == "moving")
        return cls(description, model, reduction, chain, locked, cumulative, base, machine)

    @property
    def hip(self) -> FloatArray:
        """Origin of the first joint in the axes of the root link [m], (3,)."""
        return np.array(self.model.jointPlacements[1].translation)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints in the URDF, from the torso outwards."""
        return tuple(self.model.names)[1:]

    @property
    def limbs(self) -> tuple[Limb, ...]:
        """Planar chains of the leg: one, or those of a machine; () if it is not planar."""
        if self.chain is not None:
            return (Limb(self.chain, slice(0, self.chain.n), "", np.zeros(2)),)
        return () if self.machine is None else self.machine.limbs

    @property
    def base_rows(self) -> int:
        """Number of rows of a floating base, before those of the joints: 3 in a plane, otherwise 6; 0 without one."""
        return len(self.row_names) - len(self.joint_names)

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names of the rows: forces and moments on a floating base, and the joints.

        The rows of a planar base are the force forward and up [N], in axes that turn with the torso, and the moment
        about the hip [N·m], positive like the pitch. Others are force and moment about the origin of the root link.
        """
        if self.base != "floating":
            return self.joint_names
        return (*(FREE_ROWS if self.machine is None else PLANAR_ROWS), *self.joint_names)

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Joint names without ``left_`` or ``right_``, which occur in the names of parameters."""
        return _without_side(self.joint_names)

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links that the joints carry."""
        return tuple(self.description.child_links[joint] for joint in self.joint_names)

    @property
    def link_labels(self) -> tuple[str, ...]:
        """Link names without ``left_`` or ``right_``."""
        return _without_side(self.link_names)

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
        values = self.reduction.parameters(dynamic_parameters(self.model, root=self.base == "floating"))
        values.flags.writeable = False
        return values

    @property
    def limits(self) -> JointLimits:
        """Limits of the joints."""
        model = self.model
        joints = [model.joints[j] for j in range(1, model.njoints)]
        turning = np.array([joint.nq == 2 for joint in joints])  # continuous joints have no limits
        lower = np.array([model.lowerPositionLimit[joint.idx_q] for joint in joints])
        upper = np.array([model.upperPositionLimit[joint.idx_q] for joint in joints])
        lower, upper = np.where(turning, -np.inf, lower), np.where(turning, np.inf, upper)
        return JointLimits(lower, upper, model.velocityLimit.copy(), model.effortLimit.copy())

    def with_parameters(self, values: ArrayLike) -> Leg:
        """Change the parameters.

        Masses do not change, so single links may become physically inconsistent.

        Args:
            values: Parameters in the order of :attr:`parameter_names`, (p,).

        Returns:
            The leg with these parameters.

        Raises:
            ExoidError: The number of values is wrong, or one is not finite.
        """
        array = _numbers(values)
        if array.shape != self.parameters.shape or not np.isfinite(array).all():
            raise ExoidError(f"expected {len(self.parameter_names)} finite values for {self.parameter_names}")
        own = dynamic_parameters(self.model, root=self.base == "floating")
        adjusted = self.reduction.adjust(own, array)
        return replace(self, model=with_dynamic_parameters(self.model, adjusted))

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
        if self.chain is not None:
            moved = None if torso is None else torso_samples(torso, len(q), self.chain.plane, self.hip)
            fill_regressor(self.chain, q, v, a, out, cumulative=self.cumulative, torso=moved)
        elif self.machine is not None:
            within = None if torso is None else self._within_plane(torso, len(q))
            self.machine.fill_regressor(q, v, a, out, cumulative=self.cumulative, torso=within)
        elif torso is None or self.base != "fixed":
            base = None if torso is None else self._base(torso, len(q)).spatial()
            fill_reduced_regressor(self.reduction, self._tree, q, v, a, out, base)
        else:
            raise ExoidError(
                "a moving base needs more parameters unless the leg is a planar chain",
                where=self.description.name,
                remedy='make the leg with Leg.from_urdf(..., base="moving")',
                command="give --moving-base",
            )

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: MovingBase | None = None) -> FloatArray:
        """Compute joint torques, and the rows of a floating base, by the recursive Newton-Euler algorithm (RNEA).

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso, or of the base in space with all that it adds; None if it is upright and still.

        Returns:
            Torques [N·m], (N, n); of a floating base (N, base_rows + n), see :attr:`row_names`.

        Raises:
            ExoidError: Shapes do not fit.
        """
        samples = self.samples(q, v, a)
        if self.base == "floating" or not isinstance(torso, TorsoMotion | None):
            q, v, a = samples
            rows = inverse_dynamics_on_base(self._free, q, v, a, *self._base(torso, len(q)).spatial())
            return project_columns(rows, self._base_coordinates)
        if torso is None:
            return inverse_dynamics(self.model, *samples)
        moved = (
            np.hstack(pair) for pair in zip(torso_coordinates(torso.samples(len(samples[0]))), samples, strict=True)
        )
        return inverse_dynamics(self._on_torso, *moved)[:, TORSO_JOINTS:]

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """Compute the mass matrix M(q), which does not depend on the tilt of the torso.

        Args:
            q: Joint angles [rad], (N, n).

        Returns:
            M [kg·m²], (N, n, n); of a floating base (N, base_rows + n, base_rows + n), also in kg and kg·m.

        Raises:
            ExoidError: The shape does not fit.
        """
        (q,) = self.samples(q)
        if self.base == "floating":
            return floating_mass_matrix(self._free, self._base_coordinates, q)
        return mass_matrix(self.model, q)

    def frame_jacobian(self, q: ArrayLike, link: str, point: ArrayLike = (0.0, 0.0, 0.0)) -> FloatArray:
        """Compute the Jacobian J of a point of a link: its twist per unit of each coordinate of the rows.

        Coordinates of base rows are the velocity of the base that does work with them. So a force and a moment on the
        link at the point, in its axes, act on the rows as Jᵀ (force, moment).

        Args:
            q: Joint angles [rad], (N, n).
            link: Name of a link in the URDF; the root link, or one fixed to another, too.
            point: Place of the point in the axes of the link [m], (3,).

        Returns:
            J, linear rows before angular, in the axes of the link, (N, 6, base_rows + n).

        Raises:
            ExoidError: The shape does not fit, or the URDF has no such link.
        """
        (q,) = self.samples(q)
        frame = link_frame(self.model, self.description, link)
        place = frame.placement * pin.SE3(np.eye(3), _point(point))
        J = tree_jacobian(self._tree, q, frame.body, place.inverse().action)
        return project_columns(J, self._base_coordinates) if self.base == "floating" else J

    def contact_jacobian(self, q: ArrayLike, link: str) -> FloatArray:
        """Compute the Jacobian of what a link that is fixed to the ground keeps at zero.

        For a planar leg this is the velocity of the link's origin along the axes that point forward and up at the zero
        pose and turn with the link, and its rate of turn, positive like the pitch. Otherwise it is the twist of
        :meth:`frame_jacobian`. Columns of a floating base come first; they are an invertible matrix.

        Args:
            q: Joint angles [rad], (N, n).
            link: Name of a link in the URDF.

        Returns:
            J, (N, c, base_rows + n) with c = 3 for a planar leg, otherwise 6.

        Raises:
            ExoidError: The shape does not fit, or the URDF has no such link.
        """
        J = self.frame_jacobian(q, link)
        return J if not self.limbs else planar_directions(self.model, self.description, link, self._plane) @ J

    def coriolis(self, q: ArrayLike, v: ArrayLike, torso: TorsoMotion | None = None) -> FloatArray:
        """Compute the Coriolis matrix C(q, v) with ½Ṁ − C skew-symmetric.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            torso: Motion of the torso; None if it is upright and still.

        Returns:
            C, (N, n, n). With a motion of the torso (N, n, 1 + n), where the first column multiplies the pitch rate.

        Raises:
            ExoidError: Shapes do not fit.
        """
        q, v = self.samples(q, v)
        if self.base == "floating":
            raise ExoidError(
                "a floating base has no Coriolis matrix without its velocity in space",
                where=self.description.name,
                remedy="take the rows of inverse_dynamics at zero acceleration, less those of gravity",
            )
        if torso is None:
            return coriolis_matrix(self.model, q, v)
        position, velocity, _ = torso_coordinates(torso.samples(len(q)))
        C = coriolis_matrix(self._on_torso, np.hstack([position, q]), np.hstack([velocity, v]))
        return C[:, TORSO_JOINTS:, TORSO_JOINTS - 1 :]

    def gravity(self, q: ArrayLike, torso: TorsoMotion | None = None) -> FloatArray:
        """Compute the gravity torque G(q).

        Args:
            q: Joint angles [rad], (N, n).
            torso: Motion of the torso, only the pitch of which has an effect; None if it is upright.

        Returns:
            G [N·m], (N, n); of a floating base (N, base_rows + n), see :attr:`row_names`.

        Raises:
            ExoidError: The shape does not fit.
        """
        (q,) = self.samples(q)
        if self.base == "floating":
            still = np.zeros_like(q)
            return self.inverse_dynamics(q, still, still, None if torso is None else TorsoMotion(torso.pitch))
        if torso is None:
            return gravity_torque(self.model, q)
        position, _, _ = torso_coordinates(torso.samples(len(q)))
        return gravity_torque(self._on_torso, np.hstack([position, q]))[:, TORSO_JOINTS:]

    def gravity_of_tilted_torso(self, pitch: float) -> FloatArray:
        """Compute gravity in the base frame of a tilted torso.

        Args:
            pitch: Tilt of the torso [rad].

        Returns:
            Gravity [m/s²], (3,).
        """
        _, lateral, _ = self._plane
        return np.asarray(pin.exp3(pitch * lateral) @ self.model.gravity.linear)

    def forward_kinematics(self, q: ArrayLike, torso: TorsoMotion | None = None) -> SegmentPlacements:
        """Compute the placement of every segment frame in the base frame.

        Args:
            q: Joint angles [rad], (N, n).
            torso: Motion of the torso, which pitches about the hip; None if it is upright.

        Returns:
            Rotations and translations.

        Raises:
            ExoidError: The shape does not fit.
        """
        (q,) = self.samples(q)
        if torso is None:
            return segment_placements(self.model, q)
        position, _, _ = torso_coordinates(torso.samples(len(q)))
        rotation, translation = segment_placements(self._on_torso, np.hstack([position, q]))
        return SegmentPlacements(rotation[:, TORSO_JOINTS:], translation[:, TORSO_JOINTS:])

    def samples(self, *arrays: ArrayLike) -> tuple[FloatArray, ...]:
        """Check that arrays have the same shape (N, n).

        Args:
            *arrays: Arrays, (N, n); a single sample (n,) counts as N = 1.

        Returns:
            The arrays in float64.

        Raises:
            ExoidError: Shapes differ, or do not fit the number of joints.
        """
        checked = tuple(np.atleast_2d(_numbers(x)) for x in arrays)
        n = len(self.joint_names)
        if any(x.shape != checked[0].shape or x.shape[1] != n or x.ndim != 2 for x in checked):
            raise ExoidError(
                f"arrays of shapes {', '.join(str(x.shape) for x in checked)} do not fit a leg of {n} joints",
                remedy=f"pass (N, {n}) arrays: samples first, then {', '.join(self.joint_names)}",
            )
        return checked

    def __repr__(self) -> str:
        """Write the URDF, the joints and the parameters."""
        kind = ("planar" if self.limbs else "numeric") + ", floating base" * (self.base == "floating")
        names = ", ".join(self.parameter_names)
        return f"Leg({self.description.name!r}, joints={self.joint_names}, {kind}: {names})"

    @property
    def _plane(self) -> Plane:
        return self.limbs[0].chain.plane if self.limbs else Plane(*np.eye(3))

    @cached_property
    def _on_torso(self) -> pin.Model:
        return moving_torso_model(self.model, self._plane)

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
        return np.eye(6) if self.machine is None else planar_coordinates(self._plane, self.hip)

    def _base(self, torso: MovingBase | None, count: int) -> BaseKinematics:
        if torso is None:
            return rest(self.model.gravity.linear, count)
        return base_kinematics(torso, count, self._plane, self.hip)

    def _within_plane(self, torso: MovingBase, count: int) -> TorsoSamples:
        """Motion within the plane; of a floating torso in axes that turn with it."""
        base = self._base(torso, count) if self.base == "floating" else torso
        return torso_samples(base, count, self._plane, self.hip)


def _numbers(values: ArrayLike) -> FloatArray:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ExoidError(f"not an array of numbers ({error})", remedy="pass numbers, samples first") from error


def _point(point: ArrayLike) -> FloatArray:
    place = _numbers(point)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ExoidError(f"the point is {point!r}", remedy="pass three finite numbers [m] in the axes of the link")
    return place


def _without_side(names: Sequence[str]) -> tuple[str, ...]:
    for side in SIDES:
        if all(name.startswith(side) and name != side for name in names):
            return tuple(name.removeprefix(side) for name in names)
    return tuple(names)
