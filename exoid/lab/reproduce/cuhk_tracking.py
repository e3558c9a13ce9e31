"""Replay of document 2's comparison of controllers, with further laws, on the same leg at the same rate and gains."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.control import SMOOTH, ControlModel, Tracking, compare_laws, gravity_friction_pd, pd, standard_laws
from exoid.control.law import AnyLaw
from exoid.control.standard_laws import SENSORS
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments import cuhk, healthy_gait
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.identification import identify
from exoid.leg.catalog import load_leg
from exoid.leg.published import cuhk as document
from exoid.leg.published import cuhk_parameters, cuhk_resistances
from exoid.rig import (
    IdealTorque,
    Payload,
    Plant,
    ProportionalDerivative,
    plant_with_payloads,
    simulate,
)

from .cuhk import DURATION, MOTOR, PREPARATION, RATES, SERVOS, SETTLE, TERMS

GAINS = {"kp": (22.0, 55.0), "kd": (2.2, 5.5)}
"""Gains of hip and knee [N·m/rad, N·m·s/rad], which document 2 does not print.

With these gains PD has the peak errors of the document, 15° and 12°, on the rig with and without rotors.
"""

PERIOD, PERIODS, AMPLITUDE = 10.0, 2, 1.2
"""Period of document 2's stride [s], number of strides, and factor of the amplitude, which is not printed.

The first stride is not evaluated.
"""

SHANK_WEIGHT = Payload("knee", 1.5, (0.0, 0.0, -0.3))
"""Payload on the shank that the laws do not know."""

PRINTED = "Table III"
"""End of the name of the law that knows Table III as printed."""

LOADED = "+1.5kg"
"""End of the names of laws on the rig with :data:`SHANK_WEIGHT`."""

DOCUMENT_DEG = {"pd": (15.0, 12.0), "gravity_friction_pd": (10.0, 5.0)}
"""Peak errors that document 2 reports (sec. V)."""


@dataclass(frozen=True, eq=False, repr=False)
class TrackingReplay:
    """Control laws on the CUHK-EXO with payload."""

    estimate: Estimate  # model of the laws, identified from noisy data of the same rig
    laws: Mapping[str, Tracking]  # runs of pd_30hz, pd, gravity_friction_pd, feedforward_pd, computed_torque and lqr
    # runs of the laws with a wrong model: friction times 0.5 or 1.5, an unknown weight on the shank, or the
    # document's Table III as printed; empty unless requested
    wrong: Mapping[str, Tracking]
    rotor: float  # reflected inertia of each rotor [kg·m²]
    seed: int  # seed of motion and noise


def reproduce_cuhk_tracking(
    seed: int = 0,
    rotor: float = MOTOR.armature,
    *,
    wrong: bool = False,
    progress: Callable[[float], None] | None = None,
) -> TrackingReplay:
    """Identify the leg on the rig, then let every law follow the gait.

    Args:
        seed: Seed of the multisine and the sensor noise.
        rotor: Reflected inertia of each rotor [kg·m²].
        wrong: Whether laws with a wrong model of the leg run too.
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
    misinformed = wrong_laws(estimate) if wrong else {}
    heavy = plant_with_payloads(plant, [SHANK_WEIGHT])
    runs = compare_laws(
        {name: heavy if name.endswith(LOADED) else plant for name in (*laws, *misinformed)},
        laws | misinformed,
        healthy_gait(AMPLITUDE, PERIOD),
        PERIODS * PERIOD,
        sensors=SENSORS,
        settle=PERIOD,
        seed=seed,
        progress=lambda share: report(0.4 + 0.6 * share),
    )
    report(1.0)
    of_laws, of_misinformed = ({name: runs[name] for name in names} for names in (laws, misinformed))
    return TrackingReplay(estimate, of_laws, of_misinformed, float(rotor), seed)


def tracking_plant(rotor: float = MOTOR.armature) -> Plant:
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


def wrong_laws(source: Estimate | ControlModel) -> dict[str, AnyLaw]:
    """Make the same laws with a wrong model, by name; those that end in :data:`LOADED` are for the rig with payload."""
    model = ControlModel.of(source)
    laws: dict[str, AnyLaw] = {}
    for factor in (0.5, 1.5):
        scaled = document_laws(model.with_friction(factor))
        laws |= {f"{name} F x{factor:g}": law for name, law in scaled.items() if name not in ("pd_30hz", "pd")}
    laws |= {f"{name} {LOADED}": law for name, law in document_laws(model).items() if name != "pd_30hz"}
    with warnings.catch_warnings():  # the warning is expected: the model is wrong
        warnings.simplefilter("ignore", UserWarning)
        laws[f"gravity_friction_pd {PRINTED}"] = gravity_friction_pd(
            table_iii_model(), GAINS["kp"], GAINS["kd"], friction=SMOOTH
        )
    return laws


def table_iii_model() -> ControlModel:
    """Make the model of document 2's Table III as printed, with negative inertias and friction that adds energy."""
    # θ is taken in radians, and b_k0, which has no number, as zero.
    table = document().tables["III"]
    hip, knee = table.column("hip"), table.column("knee")
    leg = load_leg("cuhk")
    both = {**hip, **knee}

    def row(name: str) -> FloatArray:
        """Values of hip and knee."""
        return np.array([hip[name].value, knee[name].value])

    return ControlModel(
        leg=leg.with_parameters([both[name].value for name in leg.parameter_names]),
        spring=np.array([row("stiffness"), row("offset")]),
        coulomb=row("sign_coefficient"),
        viscous=row("viscous"),
        armature=np.zeros(2),
    )
