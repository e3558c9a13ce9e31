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
from .model import build_model, dynamic_parameters, with_dynamic_parameters
from .reduction import (
    BaseSamples,
    PlanarChain,
    Plane,
    Reduction,
    Tree,
    documented,
    fill_regressor,
    fill_tree_regressor,
    numeric,
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

Base = Literal["fixed", "moving"]
"""Whether the base of the leg stands, or moves in space."""


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
            more than on a fixed base.
    """

    description: Description
    model: pin.Model
    reduction: Reduction
    chain: PlanarChain | None
    locked: Mapping[str, float] = field(default_factory=dict)
    cumulative: bool = True
    base: Base = "fixed"

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
                base within its plane without it.

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
            raise ExoidError(f"base is {base!r}", remedy='pass base="fixed" or base="moving"')
        locked = MappingProxyType(dict(locked or {}))
        model = build_model(description, joints, locked)
        chain = PlanarChain.from_model(model) if base == "fixed" else None
        if chain is not None:
            reduction = documented(chain, cumulative=cumulative)
        else:
            links = [description.child_links[name] for name in list(model.names)[1:]]
            reduction = numeric(model, _without_side(links), moving_base=base == "moving")
        return cls(description, model, reduction, chain, locked, cumulative, base)

    @property
    def hip(self) -> FloatArray:
        """Origin of the first joint in the axes of the root link [m], (3,)."""
        return np.array(self.model.jointPlacements[1].translation)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints in the URDF, from the torso outwards."""
        return tuple(self.model.names)[1:]

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
        values = self.reduction.parameters(dynamic_parameters(self.model))
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
        adjusted = self.reduction.adjust(dynamic_parameters(self.model), array)
        return replace(self, model=with_dynamic_parameters(self.model, adjusted))

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: MovingBase | None = None) -> FloatArray:
        """Form the regressor W of the parameters: τ = W(q, v, a) β.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso or of the base in space, of which a planar chain takes the part within its plane;
                None if it is upright and still.

        Returns:
            W, (N, n, p), each column contiguous in memory.

        Raises:
            ExoidError: Shapes do not fit, or the base of a leg moves that is neither a planar chain nor made for that.
        """
        q, v, a = self.samples(q, v, a)
        out = np.zeros((len(self.parameter_names), *q.shape[::-1]))
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
            out: Receives Wᵀ, zeroed, (p, n, N).
            torso: Motion of the torso, or of the base; see :meth:`regressor`.

        Raises:
            ExoidError: The base of a leg moves that is neither a planar chain nor made for that.
        """
        if self.chain is not None:
            moved = None if torso is None else torso_samples(torso, len(q), self.chain.plane, self.hip)
            fill_regressor(self.chain, q, v, a, out, cumulative=self.cumulative, torso=moved)
        elif torso is None:
            self._fill_numeric(q, v, a, out)
        elif self.base == "moving":
            self._fill_numeric(q, v, a, out, base_kinematics(torso, len(q), self._plane, self.hip).spatial())
        else:
            raise ExoidError(
                "a moving base needs more parameters unless the leg is a planar chain",
                where=self.description.name,
                remedy='make the leg with Leg.from_urdf(..., base="moving")',
                command="give --moving-base",
            )

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: MovingBase | None = None) -> FloatArray:
        """Compute joint torques by Pinocchio's recursive Newton-Euler algorithm (RNEA).

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso, or of the base in space with all that it adds; None if it is upright and still.

        Returns:
            Torques [N·m], (N, n).

        Raises:
            ExoidError: Shapes do not fit.
        """
        samples = self.samples(q, v, a)
        if torso is None:
            return inverse_dynamics(self.model, *samples)
        if not isinstance(torso, TorsoMotion):
            base = base_kinematics(torso, len(samples[0]), self._plane, self.hip)
            q, v, a = samples
            return inverse_dynamics_on_base(self.model, q, v, a, *base.spatial())
        moved = (
            np.hstack(pair) for pair in zip(torso_coordinates(torso.samples(len(samples[0]))), samples, strict=True)
        )
        return inverse_dynamics(self._on_torso, *moved)[:, TORSO_JOINTS:]

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """Compute the mass matrix M(q), which does not depend on the tilt of the torso.

        Args:
            q: Joint angles [rad], (N, n).

        Returns:
            M [kg·m²], (N, n, n).

        Raises:
            ExoidError: The shape does not fit.
        """
        return mass_matrix(self.model, *self.samples(q))

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
            G [N·m], (N, n).

        Raises:
            ExoidError: The shape does not fit.
        """
        (q,) = self.samples(q)
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
        kind = "numeric" if self.chain is None else "planar"
        names = ", ".join(self.parameter_names)
        return f"Leg({self.description.name!r}, joints={self.joint_names}, {kind}: {names})"

    @property
    def _plane(self) -> Plane:
        return self.chain.plane if self.chain is not None else Plane(*np.eye(3))

    @cached_property
    def _on_torso(self) -> pin.Model:
        return moving_torso_model(self.model, self._plane)

    @cached_property
    def _tree(self) -> Tree:
        return Tree.from_model(self.model)

    def _fill_numeric(
        self, q: FloatArray, v: FloatArray, a: FloatArray, out: FloatArray, base: BaseSamples | None = None
    ) -> None:
        columns, spread = self.reduction.columns, self.reduction.spread
        if self.reduction.selects:
            fill_tree_regressor(self._tree, q, v, a, columns, out, base)
            return
        block = 2048  # samples, which limits the memory of Pinocchio's wide regressor
        for start in range(0, len(q), block):
            rows = slice(start, start + block)
            part = out[..., rows]
            Y = np.zeros((len(columns), *part.shape[1:]))
            moved = None if base is None else BaseSamples(*(x[rows] for x in base))
            fill_tree_regressor(self._tree, q[rows], v[rows], a[rows], columns, Y, moved)
            part[:] = np.tensordot(spread[columns].T, Y, axes=1)


def _numbers(values: ArrayLike) -> FloatArray:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ExoidError(f"not an array of numbers ({error})", remedy="pass numbers, samples first") from error


def _without_side(names: Sequence[str]) -> tuple[str, ...]:
    for side in SIDES:
        if all(name.startswith(side) and name != side for name in names):
            return tuple(name.removeprefix(side) for name in names)
    return tuple(names)
