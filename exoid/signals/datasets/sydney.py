"""Swing legs of the Sydney Compass-Gait Robot: 78 s of a real leg whose only torque is the command of its amplifier."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.signals.column import Column
from exoid.signals.recording import Recording

from .dataset import Dataset, PublishedFile

COMMIT = "92546f615946c6bb43e1ebb6e23d4bf7856199aa"
URL = (
    f"https://raw.githubusercontent.com/imanchester/SydneyCompassGait/{COMMIT}"
    "/System%20Identification/SysID_Experiment%201"
)
Which = Literal["inner", "outer"]

LOGS = {
    which: PublishedFile(f"{URL}/{name}", sha256, f"sydney_swing_leg/{name}")
    for which, name, sha256 in (
        (
            "inner",
            "realVSmodel_fwAnd5vstepsx3AndChirp_innerSW.mat",
            "b61050145e156ab057f78682359da5a20c870a3ed4a0195eb31b630762c289b3",
        ),
        (
            "outer",
            "realVSmodel_fwAnd5vstepsx3AndChirp_outerSW.mat",
            "fe2e283e33254738f385b7d35ce68693b2d80b05075be3a0aa8162343b9b9329",
        ),
    )
}

COLUMNS: dict[str, str | Column] = {
    "time": "datatimeall",
    "q_leg": Column("dataoutall", unit="deg"),
    "tau_leg": Column("datainall", scale=18.3e-3),  # torque of one volt [N·m/V], ``Kt`` of the files in 1e-3 N·m
}

CITATION = (
    "I. R. Manchester et al. (University of Sydney), SydneyCompassGait, SysID_Experiment 1, 2016-08-30; MIT licence"
)


def sydney_swing_leg(which: Which = "inner") -> Dataset:
    """Load the recording from ``$EXOID_DATA_DIR`` or, after one download, from the cache.

    The leg swings freely, then its motor is commanded three steps of 5 V, then a chirp; all at 200 Hz. Torque is the
    command times the authors' constant, 18.3 mN·m/V, without delay and saturation. The encoder of the inner leg was set
    to zero at 37.85 s: notebook 10 takes the step of 18.4 mrad out. The URDF has the authors' inertia, an assumed mass.

    Args:
        which: The inner or the outer leg.

    Returns:
        Leg with joint ``leg``, the first two thirds of the recording for identification and the others, all chirp, for
        validation.

    Raises:
        ExoidError: There is no such leg, or its file is missing, or is not the published one.
    """
    if which not in LOGS:
        raise BadArgumentError(f"no swing leg {which!r}", remedy='pass "inner" or "outer"')
    leg = Leg.from_urdf(Path(__file__).resolve().parent / "sydney_swing_leg.urdf", ("leg",))
    whole = Recording.from_file(LOGS[which].path(), leg.joint_names, COLUMNS)
    rows = 2 * len(whole) // 3
    return Dataset(leg, whole.slice(None, rows), whole.slice(rows, None), CITATION)
