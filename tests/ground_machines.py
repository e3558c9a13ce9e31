"""Machines on the ground that tests share, and the equation of motion that their runs must obey."""

import numpy as np
from numpy.typing import NDArray

import exoid
from exoid.leg.description import describe
from exoid.rig.ground import GroundPlant, GroundRun, Sole

Array = NDArray[np.float64]


def residual(run: GroundRun) -> Array:
    """[W_b; W_q] π − [0; τ − resistances − Ia a] − Σ Jᵀ w of the true motion [N, N·m], (N, base + n)."""
    plant, leg = run.plant, run.plant.leg
    rows = leg.regressor(run.q, run.v, run.a, run.base) @ leg.parameters
    rows[:, leg.base_rows :] -= run.tau - plant.resistance(run.q, run.v) - plant.armature * run.a
    for link, wrench in run.wrenches.items():
        J = leg.frame_jacobian(run.q, link, wrench.point)
        rows -= np.einsum("nij,ni->nj", J, np.hstack([wrench.force, wrench.moment]))
    return np.asarray(rows)


def inverse_dynamics_residual(run: GroundRun) -> Array:
    """The same with Pinocchio's inverse dynamics in place of the regressor."""
    leg = run.plant.leg
    regressor = leg.regressor(run.q, run.v, run.a, run.base) @ leg.parameters
    return residual(run) - regressor + leg.inverse_dynamics(run.q, run.v, run.a, run.base)


def spatial_plant() -> GroundPlant:
    """BLEEX whose hips are tilted inwards, so that it is not planar, on soles with four corners each."""
    text = exoid.load_exo("bleex").description.text
    for side, tilt in (("left", 0.15), ("right", -0.15)):
        place = f'<joint name="{side}_hip"'
        before, after = text.split(place)
        text = before + place + after.replace('xyz="0.0 -1.0 0.0"', f'xyz="{tilt} -1.0 0.05"', 1)
    leg = exoid.Leg.from_description(describe(text, "tilted.urdf"), base="floating")
    soles = {
        f"{side}_foot": Sole.flat(-0.075, 0.13, -0.115, side=y, width=0.09)
        for side, y in (("left", -0.1), ("right", 0.1))
    }
    values = {f"{symbol}_left_{joint}": 0.4 for symbol in ("c0", "d", "b1", "b0") for joint in ("hip", "ankle")}
    return GroundPlant.build(leg, soles, {**values, "Ia_right_knee": 0.05})
