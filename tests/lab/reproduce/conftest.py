"""Each replay runs once in a process, for all that is tested about it."""

from __future__ import annotations

import numpy as np
import pytest

from exoid import reproduce
from exoid.lab.reproduce.tracking_report import cuhk_tracking_report
from exoid.view.style import write_figures


@pytest.fixture(scope="session")
def bleex(tmp_path_factory):
    """The default replay of document 1, as the command line runs it."""
    replay = reproduce.reproduce_bleex()[0]
    report = reproduce.bleex_report(replay)
    return {
        "json": report.data,
        "text": str(report),
        "page": report.page().html(),
        "figures": write_figures(tmp_path_factory.mktemp("bleex"), report.figures(), ["png"]),
        "band": {side: getattr(replay, side).data.upright.band.mean(axis=0) for side in ("left", "right")},
    }


@pytest.fixture(scope="session")
def cuhk(tmp_path_factory):
    """The default replay of document 2, as the command line runs it."""
    replay = reproduce.reproduce_cuhk()[0]
    report = reproduce.cuhk_report(replay)
    return {
        "json": report.data,
        "text": str(report),
        "page": report.page().html(),
        "figures": write_figures(tmp_path_factory.mktemp("cuhk"), report.figures(), ["png"]),
        "range": np.ptp(replay.measured, axis=0),
    }


@pytest.fixture(
    scope="session", params=[0.8, pytest.param(0.0, marks=pytest.mark.nightly)], ids=lambda rotor: f"rotor {rotor}"
)
def tracking(request):
    """Document 2's comparison of controllers with every law, with rotors and without."""
    replay = reproduce.reproduce_cuhk_tracking(0, request.param)
    report = cuhk_tracking_report(replay)
    return {
        "json": report.data,
        "text": str(report),
    }
