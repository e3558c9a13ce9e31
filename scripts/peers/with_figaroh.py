"""The leg identified by FIGAROH, by a subclass and a configuration as in its examples for the UR10.

Friction, rotor inertia and offset are in the model, and the joints are weighted (``wls``). Its filter gets the cut-off
that exoid chose; of 4, 8, 15, 25 and 45 Hz, with and without decimation, this cut-off with decimation by ten, its
default, has the smallest errors over both legs. Its stage ``physical_fit`` makes links that can be exported.
"""

from __future__ import annotations

import contextlib
import io
import logging
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from figaroh.identification import BaseIdentification
from figaroh.tools.regressor import build_regressor_basic
from figaroh.tools.robot import Robot
from task import Log, Outcome, Task, friction_of, states

from exoid._typing import FloatArray

CONFIGURATION = Path(__file__).with_name("figaroh.yaml")
STUDENT = 1.96
"""Half the 95 % interval of a normal distribution in standard deviations; there are hundreds of degrees of freedom."""


# user: begins
class LegIdentification(BaseIdentification):
    """Identification of one leg from a log."""

    log: Log

    def load_trajectory_data(self, data_source: str | None = None) -> dict[str, Any]:
        """Hand the log to the workflow; velocities and accelerations are derived by it."""
        return {
            "timestamps": self.log.time.reshape(-1, 1),
            "positions": self.log.q,
            "velocities": None,
            "accelerations": None,
            "torques": self.log.tau,
        }


def fit(urdf: str, configuration: str, log: Log) -> LegIdentification:
    """Run the workflow."""
    robot = Robot(urdf, str(Path(urdf).parent), isFext=False)
    identification = LegIdentification(robot, configuration)
    joints = identification.identif_config["active_joints"]
    active = [identification.model.joints[identification.model.getJointId(name)] for name in joints]
    identification.identif_config["act_idxq"] = [joint.idx_q for joint in active]
    identification.identif_config["act_idxv"] = [joint.idx_v for joint in active]
    identification.log = log
    identification.initialize()
    identification.solve(decimate=True, decimation_factor=10, plotting=False, wls=True)
    return identification


# user: ends


def identify(task: Task, log: Log) -> Outcome:
    """Identify a leg.

    Args:
        task: The task.
        log: Log for identification.

    Returns:
        What was found.
    """
    logging.disable(logging.WARNING)
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        urdf, configuration = Path(folder) / "leg.urdf", Path(folder) / "leg.yaml"
        urdf.write_text(task.urdf, encoding="utf-8")
        configuration.write_text(_configuration(task, log), encoding="utf-8")
        start = time.perf_counter()
        found = fit(str(urdf), str(configuration), log)
        seconds = time.perf_counter() - start
        export = _export(found, urdf, task.urdf)

    def regressor(q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        whole = build_regressor_basic(found.robot, q, v, a, found.identif_config)
        return np.delete(whole, found._idx_eliminated, axis=1)[:, found._base_indices]

    def torque(q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return (regressor(q, v, a) @ found.phi_base).reshape(q.shape[1], -1).T

    true = None
    if task.truth is not None:
        moved = states(len(task.leg.joint_names))
        true = np.linalg.lstsq(regressor(*moved), task.truth(*moved).T.ravel(), rcond=None)[0]
    std = np.asarray(found.result["wls_std_deviations"]) / 100.0 * np.abs(found.phi_base)
    return Outcome(torque, seconds, found.phi_base, STUDENT * std, true, export)


def _configuration(task: Task, log: Log) -> str:
    """Fill in the configuration of a leg."""
    joints = len(task.leg.joint_names)
    text = CONFIGURATION.read_text(encoding="utf-8").replace("JOINTS", ", ".join(task.leg.joint_names))
    text = text.replace("ZEROS", ", ".join("0" * joints)).replace("ONES", ", ".join("1" * joints))
    return text.replace("RATE", f"{log.rate:.6f}").replace("CUTOFF", f"{task.cutoff}")


def _export(found: LegIdentification, urdf: Path, task_urdf: str) -> str:
    """Say what the exported URDF holds."""
    try:
        file = Path(found.export_urdf(str(urdf), str(urdf.with_name("out.urdf"))))
    except ValueError as error:
        return f"refused: {error}"
    pin.buildModelFromUrdf(str(file))
    return "URDF" if friction_of(file.read_text(encoding="utf-8")) != friction_of(task_urdf) else "no"
