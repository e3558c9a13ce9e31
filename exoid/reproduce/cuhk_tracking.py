"""Document 2's comparison of controllers replayed, with the laws it lacks: same leg, same rate, same gains."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid import published
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.control import ControlModel, Law, Tracking, compare_laws, gravity_friction_pd, pd, standard_laws
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.experiments import cuhk, healthy_gait, refuse_motion_beyond_limits
from exoid.identification import identify
from exoid.rig import (
    IdealTorque,
    Payload,
    PinocchioStepper,
    Plant,
    ProportionalDerivative,
    plant_with_payloads,
    simulate,
)

from .cuhk import DURATION, MOTOR, PREPARATION, RATES, SENSORS, SERVOS, SETTLE, TERMS

GAINS = {"kp": (22.0, 55.0), "kd": (2.2, 5.5)}
"""Of hip and knee [N·m/rad, N·m·s/rad]. Document 2 prints none: with these its PD errs by its 15° and 12°, on the rig
with rotors and without; kd is a tenth of kp."""

PERIOD, PERIODS, AMPLITUDE = 10.0, 2, 1.2
"""Stride of document 2 [s], how many are walked (the first is not counted), and the factor by which its amplitude is
enlarged, which is not printed."""

SLOW = 30.0
"""Rate of document 2's PD controller [Hz]; everything else runs at its 100."""

SHANK_WEIGHT = Payload("knee", 1.5, (0.0, 0.0, -0.3))
"""That no law is told of."""

PRINTED = "Table III"
LOADED = "+1.5kg"
"""End of the names of laws on the rig with that weight."""

DOCUMENT_DEG = {"pd": (15.0, 12.0), "pd_gravity_friction": (10.0, 5.0)}
"""Peak errors that document 2 reports (sec. V)."""


@dataclass(frozen=True, eq=False)
class TrackingReplay:
    """Laws on the CUHK-EXO with payload.

    Attributes:
        estimate: What the laws know of the leg, identified from noisy data of the same rig.
        laws: pd_30hz, pd, pd_gravity_friction, pd_feedforward, computed_torque and lqr.
        wrong: The same laws where they are told wrong: with friction times 0.5 or 1.5, a weight on the shank, or the
            document's Table III as printed; empty if not asked for.
        rotor: Reflected inertia of each rotor [kg·m²].
        seed: Of motion and noise.
    """

    estimate: Estimate
    laws: Mapping[str, Tracking]
    wrong: Mapping[str, Tracking]
    rotor: float
    seed: int


def reproduce_cuhk_tracking(
    seed: int = 0,
    rotor: float = MOTOR.armature,
    *,
    wrong: bool = False,
    progress: Callable[[float], None] | None = None,
) -> TrackingReplay:
    """Identify the leg on the rig, then let every law follow the gait.

    Args:
        seed: Of the multisine and the sensor noise.
        rotor: Reflected inertia of each rotor [kg·m²].
        wrong: Whether laws that know the leg wrongly run too.
        progress: Told the share that is done.

    Raises:
        ExoidError: The rotor's inertia is negative or not finite.
    """
    told = progress or (lambda _: None)
    plant = tracking_plant(rotor)
    estimate = identify_for_tracking(plant, seed, lambda share: told(0.4 * share))
    laws = document_laws(estimate)
    ill = wrong_laws(estimate) if wrong else {}
    heavy = plant_with_payloads(plant, [SHANK_WEIGHT])
    runs = compare_laws(
        {name: heavy if name.endswith(LOADED) else plant for name in (*laws, *ill)},
        laws | ill,
        healthy_gait(AMPLITUDE, PERIOD),
        PERIODS * PERIOD,
        sensors=SENSORS,
        settle=PERIOD,
        seed=seed,
        progress=lambda share: told(0.4 + 0.6 * share),
    )
    told(1.0)
    right, doubtful = ({name: runs[name] for name in names} for names in (laws, ill))
    return TrackingReplay(estimate, right, doubtful, float(rotor), seed)


def tracking_plant(rotor: float = MOTOR.armature) -> Plant:
    """The CUHK-EXO with a wearer's payload, friction, and rotors of the given inertia at the joint [kg·m²].

    Raises:
        ExoidError: The inertia is negative or not finite.
    """
    if not 0.0 <= rotor < np.inf:
        raise ExoidError(f"rotors of {rotor:g} kg·m²", remedy="give their inertia at the joint, zero or positive")
    values = {**published.cuhk_parameters(), **published.cuhk_resistances()}
    return Plant.build(load_leg("cuhk"), {**values, "Ia_hip": rotor, "Ia_knee": rotor})


def identify_for_tracking(plant: Plant, seed: int, progress: Callable[[float], None] | None = None) -> Estimate:
    """Identify the leg of a rig from a multisine under a gentle servo, read by noisy sensors."""
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
        stepper=PinocchioStepper,
        progress=progress,
    )
    return identify(plant.leg, run.recording().between(SETTLE, DURATION), TERMS, preparation=PREPARATION)


def document_laws(source: Estimate | ControlModel) -> dict[str, Law]:
    """Laws at document 2's gains, by name; its PD at its rate and at that of the others."""
    kp, kd = GAINS["kp"], GAINS["kd"]
    gait = healthy_gait(AMPLITUDE, PERIOD)
    return {"pd_30hz": pd(kp, kd, rate=SLOW), **standard_laws(source, kp, kd, gait, PERIOD)}


def wrong_laws(source: Estimate | ControlModel) -> dict[str, Law]:
    """The same laws on a wrong model, by name; those with a weight on the shank belong on a rig that has it."""
    model = ControlModel.of(source)
    laws: dict[str, Law] = {}
    for factor in (0.5, 1.5):
        told = document_laws(model.with_friction(factor))
        laws |= {f"{name} F x{factor:g}": law for name, law in told.items() if name not in ("pd_30hz", "pd")}
    laws |= {f"{name} {LOADED}": law for name, law in document_laws(model).items() if name != "pd_30hz"}
    with warnings.catch_warnings():  # that this is wrong is what it is to show
        warnings.simplefilter("ignore", UserWarning)
        laws[f"pd_gravity_friction {PRINTED}"] = gravity_friction_pd(table_iii_model(), GAINS["kp"], GAINS["kd"])
    return laws


def table_iii_model() -> ControlModel:
    """Document 2's Table III as printed: no physical leg, with friction that drives; a law on it must warn.

    θ is taken in radians, and b_k0, which has no number, as zero.
    """
    table = published.cuhk().table("III")
    hip, knee = table.column("hip"), table.column("knee")
    leg = load_leg("cuhk")
    both = {**hip, **knee}

    def row(name: str) -> FloatArray:
        return np.array([hip[name].value, knee[name].value])

    return ControlModel(
        leg=leg.with_parameters([both[name].value for name in leg.parameter_names]),
        spring=np.array([row("stiffness"), row("offset")]),
        coulomb=row("sign_coefficient"),
        viscous=row("viscous"),
        armature=np.zeros(2),
    )
