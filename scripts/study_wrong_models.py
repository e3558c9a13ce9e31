"""Control laws with a wrong model of the CUHK-EXO: half the friction or more, an unknown weight, Table III as printed.

``python scripts/study_wrong_models.py`` (a minute) prints the second table of docs/control.md, with rig and gains of
``exoid reproduce tracking``. F x0.5 and F x1.5 scale the friction that the laws know; +1.5kg is a weight on the shank
of the rig. Table III of the document has negative inertias and friction that adds energy.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Container
from dataclasses import replace

import numpy as np

import exoid
from exoid.control import SMOOTH, ControlModel, Tracking, compare_laws, gravity_friction_pd
from exoid.control.law import AnyLaw
from exoid.control.standard_laws import SENSORS
from exoid.control.tracking import tracking_table
from exoid.experiments import healthy_gait
from exoid.lab.reproduce.cuhk_tracking import (
    AMPLITUDE,
    GAINS,
    PERIOD,
    PERIODS,
    document_laws,
    identify_for_tracking,
    tracking_plant,
)
from exoid.rig import Payload, plant_with_payloads
from exoid.tools.tables import to_text

WEIGHT = Payload("knee", 1.5, (0.0, 0.0, -0.3))
PRINTED, LOADED = "Table III", "+1.5kg"
"""Ends of names of laws."""


def wrong_laws(model: ControlModel) -> dict[str, AnyLaw]:
    """Make the laws with a wrong model, by name; those that end in :data:`LOADED` are for the rig with the weight."""
    laws: dict[str, AnyLaw] = {}
    for factor in (0.5, 1.5):
        scaled = document_laws(replace(model, coulomb=factor * model.coulomb, viscous=factor * model.viscous))
        laws |= {f"{name} F x{factor:g}": law for name, law in scaled.items() if name not in ("pd_30hz", "pd")}
    laws |= {f"{name} {LOADED}": law for name, law in document_laws(model).items() if name != "pd_30hz"}
    with warnings.catch_warnings():  # the warning is expected: the model is wrong
        warnings.simplefilter("ignore", UserWarning)
        printed = gravity_friction_pd(table_iii_model(), GAINS["kp"], GAINS["kd"], friction=SMOOTH)
    return laws | {f"gravity_friction_pd {PRINTED}": printed}


def table_iii_model() -> ControlModel:
    """Make the model of document 2's Table III as printed, with θ in radians and b_k0, which has no number, as zero."""
    table, leg = exoid.published.cuhk().tables["III"], exoid.load_leg("cuhk")
    hip, knee = table.column("hip"), table.column("knee")
    both = {**hip, **knee}

    def row(name: str) -> np.ndarray:
        """Values of hip and knee."""
        return np.array([hip[name].value, knee[name].value])

    return ControlModel(
        leg=leg.with_parameters([both[name].value for name in leg.parameter_names]),
        spring=np.array([row("stiffness"), row("offset")]),
        coulomb=row("sign_coefficient"),
        viscous=row("viscous"),
        armature=np.zeros(2),
    )


def compare(
    seed: int = 0,
    rotor: float = 0.8,
    names: Container[str] | None = None,
    estimate: exoid.Estimate | None = None,
) -> dict[str, Tracking]:
    """Let laws, all or some of them, follow the gait on the rig; they know an estimate, by default one of this seed."""
    plant = tracking_plant(rotor)
    every = wrong_laws(ControlModel.of(estimate or identify_for_tracking(plant, seed)))
    laws = {name: law for name, law in every.items() if names is None or name in names}
    heavy = plant_with_payloads(plant, [WEIGHT])
    rigs = {name: heavy if name.endswith(LOADED) else plant for name in laws}
    gait = healthy_gait(AMPLITUDE, PERIOD)
    return compare_laws(rigs, laws, gait, PERIODS * PERIOD, sensors=SENSORS, settle=PERIOD, seed=seed)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print(to_text(tracking_table("Laws with a wrong model of the leg", compare(given.seed).values())))


if __name__ == "__main__":
    main()
