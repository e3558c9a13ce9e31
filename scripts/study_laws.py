"""What an estimate costs a controller: tracking with estimates from ten noisy seconds, beside the true parameters.

``python scripts/study_laws.py`` (some minutes of one core) identifies a virtual CUHK-EXO many times from ten seconds of
motion with 1 N·m of noise. Then controllers follow a healthy stride on the same leg, with the true parameters and with
each estimate. The excess is the mean RMS error minus that with the true parameters. PD needs no parameters.
"""

from __future__ import annotations

import argparse
import warnings

import numpy as np

import exoid
from exoid.control import ControlModel, default_gains, mean_pose, simulate_many, standard_laws
from exoid.control.standard_laws import SENSORS
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.experiments.excitation import MotionLimits, plan_excitation
from exoid.experiments.excitation.scales import Scales
from exoid.lab.study import LegText, Noise, Study, document, planned, plausible_truth
from exoid.lab.study.replicates import run_chunk
from exoid.tools.tables import make_table, to_text
from exoid.torques import DEFAULT_TERMS, TorqueModel

LAWS = ("pd", "gravity_friction_pd", "feedforward_pd", "computed_torque", "lqr")
NOISE, SECONDS, PERIOD = 1.0, 10.0, 10.0


def main() -> None:
    """Print a table for each motion of the identification."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--replicates", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1000)
    given = parser.parse_args()
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, DEFAULT_TERMS)
    truth = plausible_truth(model, Scales.of(model, MotionLimits.of(leg)).typical_torque)
    plan = plan_excitation(leg, criterion="d", starts=2, noise=NOISE, duration=SECONDS)
    study = Study(
        leg=LegText.of(leg),
        terms=DEFAULT_TERMS,
        truth=truth,
        protocols=(planned(plan), document(leg, SECONDS)),
        noises=(Noise("mixed", (NOISE, NOISE), share=0.8),),
        replicates=given.replicates,
        seed=given.seed,
        chunk=given.replicates,
    )
    known = ControlModel.of_parameters(model, np.array(truth))
    gait = gait_for_leg(leg, healthy_gait(0.8, PERIOD))
    kp, _ = default_gains(known, mean_pose(gait, PERIOD))
    warnings.simplefilter("ignore", UserWarning)  # about negative friction due to noise
    for number, protocol in enumerate(study.protocols):
        values = run_chunk(study, number)[0][0]
        models = [known, *(ControlModel.of_parameters(model, each) for each in values)]
        rows = []
        for name in LAWS:
            laws = [standard_laws(each, kp, 0.1 * kp, gait, PERIOD, names=(name,))[name] for each in models]
            plant = known.plant().repeat(len(laws))
            runs = simulate_many(plant, laws, gait, 2 * PERIOD, sensors=SENSORS, settle=PERIOD)
            exact, errors = runs[0].rms_deg, np.array([run.rms_deg for run in runs[1:]])
            for j, label in enumerate(leg.joint_labels):
                own = errors[:, j]
                cells = (f"{x:.3f}" for x in (exact[j], own.mean(), own.std(ddof=1), own.max(), own.mean() - exact[j]))
                rows.append((name if j == 0 else "", label, *cells))
        headers = ("controller", "joint", "with the truth [°]", "with estimates", "std", "worst", "excess")
        print(f"\n{protocol.name}, {given.replicates} estimates, rms tracking error\n")
        print(to_text(make_table(headers, rows)))


if __name__ == "__main__":
    main()
