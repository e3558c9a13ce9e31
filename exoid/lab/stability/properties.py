"""Numerical test of document 2's Properties 1 to 3 of a leg's equations of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.control.model import ControlModel, ModelSource
from exoid.errors import BadArgumentError
from exoid.tools.json_values import attributes
from exoid.tools.tables import make_table, to_text

EXACT = 1e-9
"""Relative error below which an identity holds: that of a numerical derivative."""

SPEEDS = np.array([1.0, 10.0, 100.0, 1000.0])
"""Speeds at which Coriolis and friction torques are evaluated [rad/s]."""

STEP = 2e-3
"""Step of the numerical derivative of M along the motion [s]; its error is the fourth power of the step / 30."""


@dataclass(frozen=True, eq=False, repr=False)
class ModelProperties:
    """Evidence for or against doc. 2's Properties 1, 2 and 3 (sec. III-C); prints itself as a table."""

    poses: int  # number of random poses and velocities
    asymmetry: float  # largest |M − Mᵀ| relative to |M|
    smallest_inertia: float  # smallest eigenvalue of M at any pose [kg·m²]
    worst_pose: FloatArray  # pose of the smallest eigenvalue [rad], (n,)
    skewness: float  # largest |P + Pᵀ| with P = ½ Ṁ − C, relative to the largest |Ṁ|; 0 for a constant M
    speeds: FloatArray  # speeds [rad/s], (S,)
    coriolis: FloatArray  # largest spectral norm of C at these speeds [N·m·s/rad], (S,)
    gravity: float  # largest gravity torque of any joint [N·m]
    friction: FloatArray  # largest friction torque of any joint at these speeds [N·m], (S,)

    @property
    def symmetric_positive_definite(self) -> bool:
        """Property 1: M(θ) is symmetric and positive definite."""
        return self.asymmetry <= EXACT and self.smallest_inertia > 0.0

    @property
    def skew_symmetric(self) -> bool:
        """Property 2: ½ Ṁ − C is skew-symmetric."""
        return self.skewness <= EXACT

    @property
    def coriolis_bounded(self) -> bool:
        """Whether C is bounded for all θ̇: only if it is zero, as it is linear in θ̇."""
        return bool(self.coriolis.max() <= EXACT)

    @property
    def friction_bounded(self) -> bool:
        """Whether friction is bounded for all θ̇: only without viscous friction."""
        return bool(self.friction[-1] <= (1.0 + EXACT) * self.friction[-2])

    @property
    def bounded(self) -> bool:
        """Property 3: C, G and F_r are all bounded for all θ and θ̇."""
        return self.coriolis_bounded and self.friction_bounded

    def to_json(self) -> dict[str, Any]:
        """Convert results and evidence to JSON types."""
        results = ("symmetric_positive_definite", "skew_symmetric", "bounded")
        evidence = ("smallest_inertia", "skewness", "speeds", "coriolis", "friction", "gravity")
        return attributes(self, *results, *evidence)

    def __repr__(self) -> str:
        """Name the properties that hold."""
        results = (self.symmetric_positive_definite, self.skew_symmetric, self.bounded)
        return f"ModelProperties({', '.join(f'{k}: {holds}' for k, holds in enumerate(results, start=1))})"

    def __str__(self) -> str:
        """Print as a table."""
        fast, slow = f"{self.speeds[-1]:g}", f"{self.speeds[0]:g}"
        pose = ", ".join(f"{np.rad2deg(x):.0f}°" for x in self.worst_pose)
        rows = [
            (
                "1: M symmetric positive definite",
                _yes_or_no(self.symmetric_positive_definite),
                f"asymmetry {self.asymmetry:.0e}; smallest eigenvalue {self.smallest_inertia:.4g} kg·m² at ({pose})",
            ),
            ("2: ½Ṁ − C skew-symmetric", _yes_or_no(self.skew_symmetric), f"up to {self.skewness:.0e} of |Ṁ|"),
            ("3: C, G and F_r bounded", _yes_or_no(self.bounded), "all three must be"),
            (
                "   C(θ, θ̇)",
                _yes_or_no(self.coriolis_bounded),
                f"|C| {self.coriolis[0]:.3g} at {slow} rad/s, {self.coriolis[-1]:.3g} at {fast}: linear in θ̇",
            ),
            ("   G(θ)", _yes_or_no(True), f"at most {self.gravity:.4g} N·m"),
            (
                "   F_r(θ, θ̇)",
                _yes_or_no(self.friction_bounded),
                f"{self.friction[0]:.3g} N·m at {slow} rad/s, {self.friction[-1]:.3g} at {fast}",
            ),
        ]
        table = make_table(("property (doc. 2, sec. III-C)", "holds", "evidence"), rows)
        return to_text(table, f"at {self.poses} random poses and velocities")


def check_properties(source: ModelSource, *, poses: int = 500, seed: int | np.random.Generator = 0) -> ModelProperties:
    """Search for counterexamples to doc. 2's Properties 1 to 3.

    The rate of M is a numerical derivative along the motion, so the test of Property 2 does not use the formula for C.

    Args:
        source: Source of the model.
        poses: Number of random poses, over the full circle, and velocities up to 1 rad/s.
        seed: Seed of the poses and velocities.

    Returns:
        Evidence for each property.

    Raises:
        ExoidError: The number of poses is not positive, or the source has no control model.
    """
    if poses < 1:
        raise BadArgumentError(f"properties at {poses} poses", remedy="check at least one pose")
    model, rng = ControlModel.of(source), np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (poses, model.n))
    v = rng.uniform(-1.0, 1.0, (poses, model.n))

    def mass_matrix(q: FloatArray) -> FloatArray:
        """Mass matrices with rotors, (N, n, n)."""
        return np.asarray(model.leg.mass_matrix(q) + model.rotors(q))

    M, C = mass_matrix(q), model.leg.coriolis(q, v)
    eigenvalues = np.linalg.eigvalsh(0.5 * (M + np.swapaxes(M, 1, 2)))[:, 0]
    at = [mass_matrix(q + k * STEP * v) for k in (-2, -1, 1, 2)]
    M_rate = (at[0] - 8.0 * at[1] + 8.0 * at[2] - at[3]) / (12.0 * STEP)  # Ṁ along the motion
    P = 0.5 * M_rate - C
    change, inertia = np.abs(M_rate).max(), np.abs(M).max()
    size = np.linalg.norm(C, ord=2, axis=(1, 2)) / np.linalg.norm(v, axis=1)
    return ModelProperties(
        poses=poses,
        asymmetry=float(np.abs(M - np.swapaxes(M, 1, 2)).max() / inertia),
        smallest_inertia=float(eigenvalues.min()),
        worst_pose=q[int(eigenvalues.argmin())],
        # A change of M that is only rounding is none.
        skewness=float(np.abs(P + np.swapaxes(P, 1, 2)).max() / change) if change > EXACT * inertia else 0.0,
        speeds=SPEEDS,
        coriolis=size.max() * SPEEDS,  # C is linear in θ̇
        gravity=float(np.abs(model.leg.gravity(q)).max()),
        friction=np.array([np.abs(model.friction(q.T, np.full_like(q.T, x), 0.0)).max() for x in SPEEDS]),
    )


def _yes_or_no(holds: bool) -> str:
    return "yes" if holds else "no"
