"""Torque model of a leg: rigid-body dynamics and terms as regressor columns times parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.leg.closure import Closure
from exoid.leg.leg import Leg
from exoid.leg.leg_data import without_side
from exoid.leg.payload import Payload
from exoid.leg.torso import MovingBase
from exoid.regression.model import RegressorModel
from exoid.signals import Poses, Recording, Wrench, wrenches_on_links

from .catalog import at_slide, turning_joints
from .motion import BLOCK, ExtraColumns, LoadedMotion, Motion, random_base, random_motion
from .payloads import payload_torque
from .position_units import heading, position_units
from .presliding import Presliding
from .regrouping import Regrouped, regroup
from .term import Term, TermBlock, load_motion

Measured = TypeVar("Measured", Recording, Poses, Recording | Poses)


@dataclass(frozen=True, eq=False, repr=False)
class TorqueModel(RegressorModel):
    """Torque model of a leg, τ = W(q, v, a) β with β = (leg parameters, term parameters).

    Attributes:
        leg: The rigid bodies.
        terms: Terms that add to the rigid-body torque.
        rigid: Leg parameters whose torque loads the joints, (p,), for terms that depend on it; None for the leg's own.
        regrouped: Parameters of terms that other parameters include, because no motion distinguishes them (a rotor at
            the hip from J1). The constructor finds them, unless they are given for the same leg and terms.
        separate: Parameters that are not regrouped although no motion distinguishes them, as their values are known.
        extras: Columns behind those of the parameters, such as faults of a log; a fit has none.

    Raises:
        ExoidError: The leg is none, a parameter occurs twice, a joint is missing, or ``regrouped`` is of other terms.

    Example:
        >>> model = TorqueModel(exoid.load_leg("cuhk"), (Armature(), Viscous()))
        >>> model.names
        ('X1', 'Y1', 'J1', 'X2', 'Y2', 'J2', 'Ia_knee', 'd_hip', 'd_knee')
        >>> print(*model.regrouped)
        Ia_hip is regrouped into J1: no motion distinguishes them
    """

    leg: Leg
    terms: tuple[Term, ...]
    rigid: FloatArray | None = None
    regrouped: tuple[Regrouped, ...] = None  # type: ignore[assignment]  # None only until it is found here
    separate: tuple[str, ...] = ()
    extras: tuple[ExtraColumns, ...] = ()

    def __post_init__(self) -> None:
        """Check names, and find what is regrouped."""
        if not isinstance(self.leg, Leg):
            raise BadArgumentError(f"{self.leg!r} is no leg", remedy="pass exoid.load_leg(…) or exoid.Leg.from_urdf(…)")
        names = self.every_name
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            what = f"parameters occur twice: {', '.join(repeated)}"
            raise BadArgumentError(what, remedy="give each term once a joint")
        if self.regrouped is None:
            object.__setattr__(self, "regrouped", self.dependent(self.separate))
        unknown = [one.name for one in self.regrouped if one.name not in names]
        if unknown:
            raise BadArgumentError(f"{', '.join(unknown)} of regrouped are no parameters", remedy="leave regrouped out")

    def __repr__(self) -> str:
        """Write leg, terms and parameters in one line."""
        terms = ", ".join(type(term).__name__ for term in self.terms)
        return f"{type(self).__name__}({self.leg.description.name!r}, terms: {terms}; {', '.join(self.names)})"

    @property
    def row_names(self) -> tuple[str, ...]:
        """Rows of the equation: the joints, behind forces and moments on a floating base."""
        return self.leg.row_names

    @property
    def row_joints(self) -> tuple[int, ...]:
        """Joint of each row; −1 for none."""
        return (-1,) * self.leg.base_rows + tuple(range(len(self.leg.joint_names)))

    @cached_property
    def blocks(self) -> tuple[TermBlock, ...]:
        """Terms joint by joint, in the order of the columns."""
        turns, found = turning_joints(self.leg), list[TermBlock]()
        for term in self.terms:
            for label, joints in term.places(self.leg.joint_names, self.leg.joint_labels).items():
                names = tuple(f"{symbol}_{label}" for symbol in term.symbols)
                found.append(TermBlock(term if turns[joints[0]] else at_slide(term), joints, names))
        return tuple(found)

    @property
    def every_name(self) -> tuple[str, ...]:
        """Names of all parameters, including the regrouped ones."""
        return (*self.leg.parameter_names, *(name for block in self.blocks for name in block.names))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in the order of the columns, (P,): all but the regrouped ones."""
        regrouped = {one.name for one in self.regrouped}
        return tuple(name for name in self.every_name if name not in regrouped)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters, (P,)."""
        units = dict(zip(self.leg.parameter_names, self.leg.parameter_units, strict=True))
        turns = turning_joints(self.leg)
        for block in self.blocks:
            of_term = block.term.units
            if not any(turns[joint] for joint in block.joints):  # a joint that slides has N, m and kg
                of_term = tuple(u.replace("N·m", "N").replace("rad", "m").replace("kg·m²", "kg") for u in of_term)
            units.update(zip(block.names, of_term, strict=True))
        for regrouped in self.regrouped:
            del units[regrouped.name]
        return tuple(units.values())

    @property
    def torque_unit(self) -> str:
        """Unit of the torques of the joints: N·m, N where all slide, "N·m or N" where some do."""
        return heading(position_units(self.leg), "{torque}")

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which columns can act on which row, (n, P) or (b + n, P); they are zero elsewhere."""
        base_rows = self.leg.base_rows
        acting = np.zeros((len(self.row_names), len(self.names)), dtype=np.bool_)
        base = None if self.leg.base == "fixed" else random_base(10)
        q, v, a = random_motion(10, len(self.leg.joint_names), self.leg.closure)
        rigid = np.zeros((len(self.leg.parameter_names), len(acting), len(q)))
        self.leg.fill_regressor(q, v, a, rigid, base)
        acting[:, : len(rigid)] = rigid.any(axis=2).T
        for block in self.blocks:
            places = [self.names.index(name) for name in block.names if name in self.names]
            acting[np.ix_([base_rows + joint for joint in block.joints], places)] = True
        return np.hstack([acting, *(extra.acting for extra in self.extras)])

    @cached_property
    def states(self) -> frozenset[tuple[int, Presliding]]:
        """Internal states that the columns depend on: joint and kind of each."""
        own = ((block.joints[0], block.term.internal_state) for block in self.blocks)
        of_terms = frozenset((joint, state) for joint, state in own if state is not None)
        return of_terms.union(*(extra.states for extra in self.extras))

    def dependent(self, apart: Sequence[str] = (), *, moving_base: bool = False) -> tuple[Regrouped, ...]:
        """Find parameters of terms that no motion tells from others, such as a rotor at the hip from J1.

        Args:
            apart: Parameters that are not looked at, as their values are known.
            moving_base: Whether the base moves, too.

        Returns:
            These parameters, with those that include them.
        """
        whole = TorqueModel(self.leg, self.terms, self.rigid, ())
        q, v, a = random_motion(10 * len(whole.names), len(self.leg.joint_names), self.leg.closure)
        base = random_base(len(q)) if moving_base or self.leg.base != "fixed" else None
        loaded = {name for block in self.blocks if block.term.loaded for name in block.names}
        columns = whole.columns(whole.motion(q, v, a, base))
        return regroup(columns, whole.names, len(self.leg.parameter_names), apart, loaded)

    @cached_property
    def nonnegative(self) -> NDArray[np.bool_]:
        """Which parameters cannot be negative in nature: friction and rotor inertia, (P,).

        One that contains a share of minus another, such as friction of the motors of a coupling, can be.
        """
        never = {
            name
            for block in self.blocks
            for symbol, name in zip(block.term.symbols, block.names, strict=True)
            if symbol in block.term.nonnegative
        }
        never -= {name for one in self.regrouped for name, share in one.into.items() if share < 0.0}
        return np.array([name in never for name in self.names], dtype=np.bool_)

    @cached_property
    def friction(self) -> NDArray[np.bool_]:
        """Which parameters belong to friction, (P,)."""
        names = {name for block in self.blocks if block.term.friction for name in block.names}
        return np.array([name in names for name in self.names], dtype=np.bool_)

    def loaded_by(self, values: FloatArray) -> TorqueModel:
        """Load the joints by the rigid-body torque of other parameters.

        Args:
            values: Parameters, (P,).

        Returns:
            The model with that load; the same model if no term depends on it.
        """
        loaded = any(block.term.loaded for block in self.blocks)
        return replace(self, rigid=values[: len(self.leg.parameter_names)]) if loaded else self

    def own_parameters(self, joint: int) -> tuple[str, ...]:
        """List the parameters that are excited only if a given joint moves.

        They are the parameters of the segment that follows the joint, and those of its terms that vanish at rest.

        Args:
            joint: Index of the joint.

        Returns:
            Their names; none for a leg that is not a planar chain.
        """
        if self.leg.chain is None:
            return ()
        parameters = [*self.leg.parameter_names[3 * joint : 3 * joint + 3]]
        for block in self.blocks:
            if block.joints == (joint,):
                still = np.zeros((len(self.leg.joint_names), 2))
                states = {(joint, state): still[0] for state in (block.term.internal_state,) if state is not None}
                columns = block.columns(LoadedMotion(still, still, still, still, still, states))
                parameters += [name for name, column in zip(block.names, columns, strict=True) if not column.any()]
        return tuple(name for name in parameters if name in self.names)

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: MovingBase | None = None) -> FloatArray:
        """Form the regressor W of all parameters: τ = W(q, v, a) β.

        Args:
            q: Joint angles [rad], (N, n), in time order if a term has an internal state.
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso; None if it is upright and still.

        Returns:
            W, (N, n, P), each column contiguous in memory.

        Raises:
            ExoidError: Shapes do not fit, or the torso of a leg that is not a planar chain moves.
        """
        return self.columns(self.motion(q, v, a, torso)).transpose(2, 1, 0)

    def motion(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        torso: MovingBase | None = None,
        payloads: Sequence[Payload] = (),
        computed: NDArray[np.bool_] | None = None,
    ) -> Motion:
        """Gather what the columns of a whole recording depend on, including internal states.

        Args:
            q: Joint angles [rad], (N, n), in time order if a term has an internal state.
            v: Joint velocities [rad/s], (N, n).
            a: Joint accelerations [rad/s²], (N, n).
            torso: Motion of the torso; None if it is upright and still.
            payloads: Payloads on the leg during the recording.
            computed: Joints whose torque follows from the reading of their drive, (n,); None for none.

        Returns:
            The motion.

        Raises:
            ExoidError: Shapes do not fit, or the leg does not have a joint that a payload names.
        """
        q, v, a = self.leg.samples(q, v, a)
        states = {(joint, kind): kind.states(q[:, joint], v[:, joint]) for joint, kind in self.states}
        motion = Motion(q, v, a, torso, states, computed=computed)
        if not payloads:
            return motion
        return motion._replace(payload=self.row_payload(payload_torque(self.leg, payloads, motion), motion.q, torso))

    def row_payload(self, payload: FloatArray, q: FloatArray, base: MovingBase | None = None) -> FloatArray:
        """Torque of payloads in the rows of the equation.

        Args:
            payload: Torque of the leg's rows [N, N·m], (N, b + n).
            q: Joint angles [rad], (N, n).
            base: Motion of the base, on which the place of ball feet depends.

        Returns:
            Torque of each row: as it is.
        """
        return payload

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns of all parameters for a motion, or for some rows of one.

        Args:
            motion: Motion of N samples.

        Returns:
            Columns, (P, n, N) or (P, b + n, N), each contiguous in memory, and the extras behind them. A linearised
            model has one more: known torque.

        Raises:
            ExoidError: The torso of a leg that is not a planar chain moves.
        """
        q, v, a, torso, *_ = motion
        names, count, base_rows = self.names, len(self.leg.parameter_names), self.leg.base_rows
        sizes = [len(names), *(extra.acting.shape[1] for extra in self.extras)]
        out = np.zeros((sum(sizes), base_rows + q.shape[1], len(q)))
        self.leg.fill_regressor(q, v, a, out[:count], torso)
        rigid = self.leg.parameters if self.rigid is None else self.rigid
        for start in range(0, len(q), BLOCK):
            rows = slice(start, start + BLOCK)
            part, row = out[:, base_rows:, rows], count
            loaded = load_motion(self.blocks, motion.rows(rows), part, rigid)
            for block in self.blocks:
                kept = [k for k, name in enumerate(block.names) if name in names]
                own, first = slice(row, row + len(kept)), block.joints[0]
                if len(kept) == len(block.names) and len(block.joints) == 1:
                    block.term.fill_block(loaded, block.joints, part[own, first : first + 1])
                elif kept:
                    part[own, list(block.joints)] = block.columns(loaded)[kept]
                row = own.stop
        of_names, *others = np.split(out, np.cumsum(sizes)[:-1])
        for extra, part in zip(self.extras, others, strict=True):
            extra.fill(motion, of_names, part)
        return out

    def select(self, recording: Measured) -> Measured:
        """Pick the joints of the leg by name, with or without their side; wrenches are those in axes of links."""
        names = self.leg.joint_names
        missing = [name for name in names if name not in recording.joint_names]
        joints = names if not missing else self.leg.joint_labels
        if not set(joints) <= set(recording.joint_names):
            raise UnreadableInputError(
                f"the leg's {', '.join(missing)} not in the recording, which has {', '.join(recording.joint_names)}",
                where=recording.file_name,
                remedy=f"map its columns, columns={{'q_{missing[0]}': '<header>', ...}}, or hold it (joints= of the "
                "leg)",
                command=f"rename its columns, or map them: --column q_{missing[0]}=HEADER "
                f"--column tau_{missing[0]}=HEADER",
                joints=tuple(missing),
            )
        if self.leg.closure is not None:
            self._refuse_dependent_torques(recording, self.leg.closure)
        found = recording if recording.joint_names == joints else recording.select(joints)
        if isinstance(found, Poses) or all(wrench.axes == "link" for wrench in found.wrenches.values()):
            return found
        return replace(found, wrenches=wrenches_on_links(self.leg, found))

    def _refuse_dependent_torques(self, recording: Recording | Poses, closure: Closure) -> None:
        """Refuse torques of the joints that follow from closed loops: these are passive."""
        if recording.tau is None:
            return
        names = self.leg.tree_joint_names
        for j in closure.dependent.tolist():
            for name in {names[j], without_side(names)[j]} & {*recording.joint_names}:
                torque = np.nan_to_num(recording.tau[:, recording.joint_names.index(name)])
                if torque.any():
                    what = (
                        f"joint {name} follows from a closed loop and is passive, and has a torque of up to "
                        f"{np.abs(torque).max():.3g} N·m"
                    )
                    remedy = "leave its torque out, or take it for an independent joint and another one as dependent"
                    raise BadArgumentError(what, where=recording.file_name, remedy=remedy, joints=(name,))

    def row_torque(self, tau: FloatArray, motion: Motion, wrenches: Mapping[str, Wrench]) -> FloatArray:
        """Form the measured side of the equation, [0; τ] + Σ J_cᵀ w_c."""
        rows = np.hstack([np.zeros((len(tau), self.leg.base_rows)), tau]) if self.leg.base_rows else tau
        for link, wrench in wrenches.items():
            if wrench.axes != "link":
                what = f"the wrench on {link} is in axes of the laboratory"
                remedy = "turn it into those of the link: exoid.signals.wrenches_on_links(leg, recording)"
                raise BadArgumentError(what, remedy=remedy)
            jacobian = self.leg.frame_jacobian(motion.q, link, wrench.point)
            rows = rows + np.einsum("ncr,nc->nr", jacobian, np.hstack([wrench.force, wrench.moment]))
        return rows

    def measured_rows(self, measured: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Tell which rows have a measured side: those of the base always, as nothing drives it."""
        return np.append(np.ones(self.leg.base_rows, dtype=np.bool_), measured)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Select the samples from which the terms can be identified."""
        usable = np.ones((len(v), len(self.leg.row_names)), dtype=np.bool_, order="F")
        for block in self.blocks:
            of_term = block.term.usable(v[:, block.joints[0] if len(block.joints) == 1 else block.joints])
            if not of_term.all():
                for joint in block.joints:
                    usable[:, self.leg.base_rows + joint] &= of_term
        return usable

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Select the samples at which a joint turns round, so that its friction is not a function of its velocity."""
        reversing, asked = np.zeros((len(v), len(self.leg.row_names)), dtype=np.bool_, order="F"), False
        for block in self.blocks:
            of_term = block.term.reversing(v[:, block.joints[0] if len(block.joints) == 1 else block.joints])
            if of_term is not None:
                asked = True
                for joint in block.joints:
                    reversing[:, self.leg.base_rows + joint] |= of_term
        return reversing if asked else None
