"""What a term may know of the motion of its joint."""

from __future__ import annotations

from typing import NamedTuple

from exoid._typing import FloatArray


class JointMotion(NamedTuple):
    """Motion of one joint over consecutive samples, and what comes with it.

    Attributes:
        q: Angle [rad], (N,).
        v: Velocity [rad/s], (N,).
        a: Acceleration [rad/s²], (N,).
        load: Rigid-body torque of the model at this joint [N·m], (N,): never the measured one.
        memory: State that depends on all samples before, of terms that have a memory, (N,).
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    load: FloatArray
    memory: FloatArray | None = None
