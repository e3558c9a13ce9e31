"""Leg: a URDF, the joints that move, and its base parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import get_args

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.tools.numbers import checked

from .closure import Closure
from .description import Description, read_description
from .dynamics import SegmentPlacements, inverse_dynamics, inverse_dynamics_on_base, joint_frames, mass_matrix
from .floating_base import free_flyer_model, project_columns
from .leg_data import LARGEST_BALL, Base, Contact, LegData, without_side
from .link_frames import held_directions, link_frame, lowest_point
from .loops import Loops
from .model import build_model, with_dynamic_parameters
from .reduction.documented import documented_machine
from .reduction.numeric import numeric
from .reduction.planar_machine import PlanarMachine
from .reduction.tree_motion import tree_jacobian
from .rewriting import RAILS, add_edges, on_rail
from .torso import MovingBase, TorsoMotion


@dataclass(frozen=True, eq=False, repr=False)
class Leg(LegData):
    """Rigid-body model of one leg, or of any other robot: a Pinocchio model and its base parameters.

    For a planar chain the parameters are (X, Y, J) of each segment, as in the documents. For any other robot they are
    numerical base parameters. For every motion, ``regressor(q, v, a) @ parameters == inverse_dynamics(q, v, a)``.

    Make a leg with :func:`exoid.load_leg`, :func:`exoid.load_exo` or :meth:`Leg.from_urdf`. See :class:`LegData` for
    the attributes: :attr:`joint_names`, :attr:`parameter_names`, :attr:`parameters` and the geometry behind them.
    """

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        joints: Sequence[str] | None = None,
        *,
        locked: Mapping[str, float] | None = None,
        cumulative: bool = True,
        base: Base = "fixed",
        contacts: Mapping[str, Contact | float | Sequence[float]] | None = None,
        loops: str | Path | None = None,
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
                "x", "y" or "z" for a base on a rail along this axis of its: the first joint is ``base_z`` then, which
                no recording has a torque of (``passive=("base_z",)``).
            contacts: Kind of contact of links that do not rest flat on the ground: "point" for a foot that holds its
                origin, a radius [m] for one that rolls on a ball about it, "edge" for a line through it, across the
                plane of the leg. For the heel and the toe of a foot, ``<foot>_heel`` and ``<foot>_toe``, the place of
                that edge in the axes of the foot [m], (3,).
            loops: TOML file of closed loops: pins, balls and welds between links, and the joints that follow from them,
                which ``joints`` leaves out; see docs/loops.md. None without loops.

        Returns:
            The leg.

        Raises:
            ExoidError: The URDF cannot be read or used, a joint or link is missing, or a loop does not close.

        Example:
            >>> leg = Leg.from_urdf("my_leg.urdf", joints=("hip", "knee"))  # doctest: +SKIP
        """
        description = read_description(path)
        return cls.from_description(
            description,
            joints,
            locked=locked,
            cumulative=cumulative,
            base=base,
            contacts=contacts,
            loops=None if loops is None else Loops.read(loops),
        )

    @classmethod
    def from_description(
        cls,
        description: Description,
        joints: Sequence[str] | None = None,
        *,
        locked: Mapping[str, float] | None = None,
        cumulative: bool = True,
        base: Base = "fixed",
        contacts: Mapping[str, Contact | float | Sequence[float]] | None = None,
        loops: Loops | None = None,
    ) -> Leg:
        """Build a leg from a description in memory.

        Args:
            description: The URDF.
            joints: See :meth:`from_urdf`.
            locked: See :meth:`from_urdf`.
            cumulative: See :meth:`from_urdf`.
            base: See :meth:`from_urdf`.
            contacts: See :meth:`from_urdf`.
            loops: Closed loops; see :meth:`from_urdf`.

        Returns:
            The leg.

        Raises:
            ExoidError: The URDF cannot be used, a joint or link is missing, or a loop does not close.
        """
        if base not in get_args(Base):
            remedy = 'pass base="fixed", base="moving" or base="floating"; or "x", "y" or "z" for a rail'
            raise BadArgumentError(f"base is {base!r}", remedy=remedy)
        if base in RAILS:
            description = on_rail(description, base)
            joints = joints if not joints or isinstance(joints, str) else (f"base_{base}", *joints)
            base = "fixed"
        locked = MappingProxyType(dict(locked or {}))
        places = {link: each for link, each in (contacts or {}).items() if not isinstance(each, str | float | int)}
        description = add_edges(description, places) if places else description
        model = build_model(description, joints, locked, () if loops is None else loops.dependent)
        kinds = _contact_kinds(model, description, {**(contacts or {}), **dict.fromkeys(places, "edge")})
        frame_of = partial(link_frame, model, description)
        closure = None if loops is None else Closure.of(loops, model, frame_of, description.name)
        floating = base == "floating"
        if floating and closure is not None:
            raise NotSupportedError(
                "closed loops behind a floating base", where=description.name, remedy='hold the base: base="fixed"'
            )
        if floating and model.inertias[0].mass <= 0.0:
            raise UnreadableInputError(
                f"the root link {description.root_link!r} of a floating base has no mass: no <inertial>?",
                where=description.name,
                remedy="add an <inertial> with mass and inertia, an estimate is enough to start",
            )
        numerical = base == "moving" or closure is not None
        machine = None if numerical else PlanarMachine.from_model(model, floating=floating)
        if machine is not None:
            reduction = documented_machine(machine, model.jointPlacements[1].translation, cumulative=cumulative)
        else:
            links = without_side([description.child_links[name] for name in list(model.names)[1:]])
            if floating:
                reduction = numeric(free_flyer_model(model), (description.root_link, *links))
            else:
                reduction = numeric(model, links, moving_base=base == "moving", closure=closure)
        return cls(description, model, reduction, machine, locked, cumulative, base, kinds, closure)

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
        array = checked(values, f"parameters ({len(self.parameter_names)} finite values)")
        if array.shape != self.parameters.shape:
            raise BadArgumentError(f"expected {len(self.parameter_names)} finite values for {self.parameter_names}")
        adjusted = self.reduction.adjust(self.link_parameters, array)
        return replace(self, model=with_dynamic_parameters(self.model, adjusted))

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
        tree = self.tree_motion(*self.samples(q, v, a))
        samples = tree.q, tree.v, tree.a
        if torso is None and self.base != "floating":
            return tree.project(inverse_dynamics(self.model, *samples))
        rows = inverse_dynamics_on_base(self._free, *samples, *self._base(torso, len(tree.q)).spatial())
        return tree.project(project_columns(rows, self._base_coordinates))

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
            M = mass_matrix(self._free, np.hstack([np.zeros((len(q), 6)), q]))
            return project_columns(project_columns(M, self._base_coordinates).swapaxes(1, 2), self._base_coordinates)
        tree = self.tree_motion(q)
        return tree.project(tree.project(mass_matrix(self.model, tree.q)).swapaxes(1, 2))

    def frame_jacobian(self, q: ArrayLike, link: str, point: ArrayLike = (0.0, 0.0, 0.0)) -> FloatArray:
        """Compute the Jacobian J of a point of a link: its twist per unit of each coordinate of the rows.

        Coordinates of base rows are the velocity of the base that does work with them. So a force and a moment on the
        link at the point, in its axes, act on the rows as Jᵀ (force, moment).

        Args:
            q: Joint angles [rad], (N, n).
            link: Name of a link in the URDF; the root link, or one fixed to another, too.
            point: Place of the point in the axes of the link [m], (3,) or (N, 3).

        Returns:
            J, linear rows before angular, in the axes of the link, (N, 6, base_rows + n).

        Raises:
            ExoidError: The shape does not fit, or the URDF has no such link.
        """
        tree = self.tree_motion(*self.samples(q))
        frame = link_frame(self.model, self.description, link)
        J = tree_jacobian(self._tree, tree.q, frame.body, frame.placement.inverse().action)
        place = checked(point, "the point", ndim=2)
        if place.shape not in ((3,), (len(J), 3)):
            raise BadArgumentError(f"the point is {point!r}", remedy="pass three numbers [m] in the axes of the link")
        if place.any():
            J[:, :3] += np.cross(J[:, 3:], np.atleast_2d(place)[..., np.newaxis], axis=1)  # v + ω × p
        return project_columns(J, self._base_coordinates) if self.base == "floating" else tree.project(J)

    def contact_jacobian(self, q: ArrayLike, link: str, up: FloatArray | None = None) -> FloatArray:
        """Compute the Jacobian of what a link in contact with the ground keeps at zero.

        For a planar leg this is the velocity of the link's origin along the axes that point forward and up at the zero
        pose and turn with the link, and its rate of turn, positive like the pitch. Otherwise it is the twist of
        :meth:`frame_jacobian`. A link whose contact is an edge or a point may turn about it. These rows are left out,
        and the others are along axes that point forward, sideward and up at the zero pose and turn with the link. For
        a ball they are those of its point of contact, which moves in the link. Columns of a floating base come first;
        for a flat contact they are an invertible matrix.

        Args:
            q: Joint angles [rad], (N, n).
            link: Name of a link in the URDF.
            up: Direction upwards in the axes of the root link, (N, 3), where a ball rests; None for their z axis.

        Returns:
            J, (N, c, base_rows + n) with c = 3 for a planar leg, otherwise 6; of an edge c = 2 or 5, of a point 2 or 3.

        Raises:
            ExoidError: The shape does not fit, or the URDF has no such link.
        """
        J = self.frame_jacobian(q, link, lowest_point(self, q, link, up))
        kind = self.contact_kind(link)
        if kind == "flat" and not self.limbs:
            return J
        directions = held_directions(self.model, self.description, link, self.plane)
        if self.limbs:
            return directions[[0, 2, 4] if kind == "flat" else [0, 2]] @ J
        return directions[[0, 1, 2, 3, 5] if kind == "edge" else [0, 1, 2]] @ J

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
        still = np.zeros_like(self.samples(q)[0])
        return self.inverse_dynamics(q, still, still, None if torso is None else TorsoMotion(torso.pitch))

    def forward_kinematics(self, q: ArrayLike, torso: TorsoMotion | None = None) -> SegmentPlacements:
        """Compute the placement of every segment frame in the base frame, of dependent joints of loops included.

        Args:
            q: Joint angles [rad], (N, n).
            torso: Motion of the torso, which pitches about the hip; None if it is upright.

        Returns:
            Rotations and translations.

        Raises:
            ExoidError: The shape does not fit.
        """
        q = self.tree_motion(*self.samples(q)).q
        rotation, place = joint_frames(self.model, q.T)
        upright = SegmentPlacements(
            np.ascontiguousarray(rotation.transpose(3, 0, 1, 2)), np.ascontiguousarray(place.transpose(2, 0, 1))
        )
        if torso is None:
            return upright
        turns = [pin.exp3(-pitch * self.plane.lateral) for pitch in torso.samples(len(q)).pitch]
        turn = np.array(turns).reshape(-1, 3, 3)
        translation = self.hip + np.einsum("nij,nkj->nki", turn, upright.translation - self.hip)
        return SegmentPlacements(np.einsum("nij,nkjl->nkil", turn, upright.rotation), translation)


def _contact_kinds(
    model: pin.Model, description: Description, kinds: Mapping[str, object]
) -> Mapping[str, Contact | float]:
    """Check the kind of contact of each link."""
    for link, kind in kinds.items():
        body, _ = link_frame(model, description, link)
        foot, _, part = link.rpartition("_")
        if part in ("heel", "toe") and kinds.get(foot, "flat") != "flat":
            raise BadArgumentError(
                f"{foot} rests on its {part}, and is a contact of the kind {kinds[foot]!r}",
                where=description.name,
                remedy=f"leave the kind of {foot} out: on heel and toe together it is flat",
            )
        ball = isinstance(kind, float | int) and 0.0 < kind <= LARGEST_BALL and body >= 0
        if not ball and kind not in get_args(Contact):
            known = f"{', '.join(get_args(Contact))}, or for a ball on a joint its radius, up to {LARGEST_BALL:g} m"
            raise BadArgumentError(f"a contact of {link} of the kind {kind!r}", remedy=f"use one of {known}")
    return MappingProxyType({**kinds})  # type: ignore[dict-item]  # each is a Contact, or a radius
