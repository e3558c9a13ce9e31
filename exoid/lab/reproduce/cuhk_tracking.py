"""Replay of document 2's comparison of controllers, with further laws, on the same leg at the same rate and gains."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid.control import SMOOTH, ControlModel, Tracking, compare_laws, gravity_friction_pd, pd, standard_laws
from exoid.control.law import AnyLaw
from exoid.control.standard_laws import SENSORS
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments import cuhk, healthy_gait
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.identification import identify
from exoid.leg.catalog import load_leg
from exoid.leg.published import cuhk_parameters, cuhk_resistances
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, simulate

from .cuhk import DURATION, PREPARATION, RATES, ROTOR, SERVOS, SETTLE, TERMS

GAINS = {"kp": (22.0, 55.0), "kd": (2.2, 5.5)}
"""Gains of hip and knee [N·m/rad, N·m·s/rad], which document 2 does not print.

With these gains PD has the peak errors of the document, 15° and 12°, on the rig with and without rotors.
"""

PERIOD, PERIODS, AMPLITUDE = 10.0, 2, 1.2
"""Period of document 2's stride [s], number of strides, and factor of the amplitude, which is not printed.

The first stride is not evaluated.
"""


@dataclass(frozen=True, eq=False, repr=False)
class TrackingReplay:
    """Control laws on the CUHK-EXO with payload."""

    estimate: Estimate  # model of the laws, identified from noisy data of the same rig
    laws: Mapping[str, Tracking]  # runs of pd_30hz, pd, gravity_friction_pd, feedforward_pd, computed_torque and lqr
    rotor: float  # reflected inertia of each rotor [kg·m²]
    seed: int  # seed of motion and noise


def reproduce_cuhk_tracking(
    seed: int = 0,
    rotor: float = ROTOR,
    *,
    progress: Callable[[float], None] | None = None,
) -> TrackingReplay:
    """Identify the leg on the rig, then let every law follow the gait.

    Args:
        seed: Seed of the multisine and the sensor noise.
        rotor: Reflected inertia of each rotor [kg·m²].
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Estimate, and runs of all laws.

    Raises:
        ExoidError: The rotor inertia is negative or not finite.
    """
    report = progress or (lambda _: None)
    plant = tracking_plant(rotor)
    estimate = identify_for_tracking(plant, seed, lambda share: report(0.4 * share))
    laws = document_laws(estimate)
    runs = compare_laws(
        plant,
        laws,
        healthy_gait(AMPLITUDE, PERIOD),
        PERIODS * PERIOD,
        sensors=SENSORS,
        settle=PERIOD,
        seed=seed,
        progress=lambda share: report(0.4 + 0.6 * share),
    )
    report(1.0)
    return TrackingReplay(estimate, runs, float(rotor), seed)


def tracking_plant(rotor: float = ROTOR) -> Plant:
    """Build the CUHK-EXO with the payload of a wearer, friction and rotors."""
    if not 0.0 <= rotor < np.inf:
        raise BadArgumentError(f"rotors of {rotor:g} kg·m²", remedy="give their inertia at the joint, zero or positive")
    values = {**cuhk_parameters(), **cuhk_resistances()}
    return Plant.build(load_leg("cuhk"), {**values, "Ia_hip": rotor, "Ia_knee": rotor})


def identify_for_tracking(plant: Plant, seed: int, progress: Callable[[float], None] | None = None) -> Estimate:
    """Identify the leg of a rig from a multisine under the servo "smooth", with noisy sensors."""
    rng = np.random.default_rng(seed)
    motion = cuhk.multisine(plant.leg, rng)
    refuse_motion_beyond_limits(plant.leg, motion, DURATION)
    run = simulate(
        plant,
        motion,
        ProportionalDerivative(*SERVOS["smooth"]),
        IdealTorque(),
        DURATION,
        sensors=SENSORS,
        rates=RATES,
        seed=rng,
        progress=progress,
    )
    return identify(plant.leg, run.recording().between(SETTLE, DURATION), TERMS, preparation=PREPARATION)


def document_laws(source: Estimate | ControlModel) -> dict[str, AnyLaw]:
    """Make the laws at document 2's gains by name, with PD at 30 and at 100 Hz."""
    kp, kd = GAINS["kp"], GAINS["kd"]
    gait = healthy_gait(AMPLITUDE, PERIOD)
    # Rate of document 2's PD controller [Hz]; all other laws run at 100 Hz.
    laws = {"pd_30hz": pd(kp, kd, rate=30.0), **standard_laws(source, kp, kd, gait, PERIOD)}
    return laws | {"gravity_friction_pd": gravity_friction_pd(source, kp, kd, friction=SMOOTH)}
