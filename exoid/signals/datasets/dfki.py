"""DFKI double pendulum, design A.0: 75 s of a real two-link arm."""

from __future__ import annotations

from exoid.leg.catalog import urdf_folder
from exoid.leg.leg import Leg
from exoid.signals.recording import Recording

from .dataset import Dataset, PublishedFile

COMMIT = "1e8544e67f3da72a51ee52fbbb278e131ce2a43f"
LOG = PublishedFile(
    f"https://raw.githubusercontent.com/dfki-ric-underactuated-lab/double_pendulum/{COMMIT}"
    "/data/experiment_records/design_A.0/20220812/sys_id/20220812-061157-PM_measured.csv",
    "af4f48db0bb984e527c7155cef9e303343cc958d8c8fc528e465823c51b615e8",
    "dfki_double_pendulum/20220812-061157-PM_measured.csv",
)
TRAIN_ROWS = 14_499
"""Number of rows for identification, up to 48.343 s; the remaining 7470 rows are for validation."""

COLUMNS = {
    "time": "time",
    **{f"q_{joint}": f"pos{i}" for i, joint in enumerate(("shoulder", "elbow"), start=1)},
    **{f"tau_{joint}": f"tau{i}" for i, joint in enumerate(("shoulder", "elbow"), start=1)},
}

CITATION = "DFKI Underactuated Lab, double_pendulum, design A.0, 2022-08-12, BSD-3-Clause"


def dfki_double_pendulum() -> Dataset:
    """Load the recording from ``$EXOID_DATA_DIR`` or, after one download, from the cache.

    The torque is the command at the joint, so that the model needs the rotor inertia. The uneven time stamps (3.3 ms on
    average) are resampled. The recorded velocity is not used: it lags the derivative of the angle by 1 to 2 ms.

    Returns:
        Leg with joints shoulder and elbow, the first 14 499 rows for identification and the others for validation.

    Raises:
        ExoidError: The file is missing and cannot be downloaded, or differs from the published one.
    """
    leg = Leg.from_urdf(urdf_folder() / "dfki_double_pendulum.urdf", ("shoulder", "elbow"))
    whole = Recording.from_csv(LOG.path(), leg.joint_names, COLUMNS, resample=False)
    train, test = whole.slice(None, TRAIN_ROWS), whole.slice(TRAIN_ROWS, None)
    return Dataset(leg, train.resampled(), test.resampled(), CITATION)
