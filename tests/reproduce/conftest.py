"""Each replay runs once, however many processes test it; what is kept is plain JSON and figures."""

from __future__ import annotations

import json
import os
import time

import numpy as np
import pytest

from exoid import reproduce
from exoid.view.figure_files import write_figures

PATIENCE = 600.0
"""How long one process waits for another's replay [s]."""


def once(folder, name, make):
    """Return what ``make`` returns, made by the first process that asks."""
    result, lock = folder / f"{name}.json", folder / f"{name}.lock"
    try:
        os.close(os.open(lock, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        deadline = time.monotonic() + PATIENCE
        while not result.exists():
            assert time.monotonic() < deadline, f"{name} was never finished"
            time.sleep(0.2)
    else:
        part = folder / f"{name}.part"
        try:
            content = make(folder / name)
        except Exception as error:
            content = {"failed": f"{type(error).__name__}: {error}"}
        part.write_text(json.dumps(content))
        part.rename(result)
    content = json.loads(result.read_text())
    assert "failed" not in content, content["failed"]
    return content


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory):
    """Folder that all processes of this test run share."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base


@pytest.fixture(scope="session")
def bleex(shared_folder):
    """The default replay of document 1, as the command line runs it."""

    def make(folder):
        replay = reproduce.reproduce_bleex()[0]
        figures = write_figures(folder, reproduce.bleex_figures(replay.left))
        band = {side: getattr(replay, side).data.upright.band.mean(axis=0).tolist() for side in ("left", "right")}
        return {
            "json": reproduce.bleex_json(replay),
            "text": reproduce.bleex_text(replay),
            "repr": [repr(thing) for thing in (replay, replay.left, replay.right, replay.left.data)],
            "page": reproduce.bleex_page(replay).html(),
            "figures": [str(path) for path in figures],
            "band": band,
        }

    return once(shared_folder, "bleex", make)


@pytest.fixture(scope="session")
def cuhk(shared_folder):
    """The default replay of document 2, as the command line runs it."""

    def make(folder):
        replay = reproduce.reproduce_cuhk()[0]
        figures = write_figures(folder, reproduce.cuhk_figures(replay))
        return {
            "json": reproduce.cuhk_json(replay),
            "text": reproduce.cuhk_text(replay),
            "repr": [repr(replay)],
            "page": reproduce.cuhk_page(replay).html(),
            "figures": [str(path) for path in figures],
            "range": np.ptp(replay.measured, axis=0).tolist(),
        }

    return once(shared_folder, "cuhk", make)


@pytest.fixture(
    scope="session", params=[0.8, pytest.param(0.0, marks=pytest.mark.slow)], ids=lambda rotor: f"rotor {rotor}"
)
def tracking(request, shared_folder):
    """Document 2's comparison of controllers with every law, with rotors and without."""

    def make(_):
        replay = reproduce.reproduce_cuhk_tracking(0, request.param, wrong=True)
        return {
            "json": reproduce.cuhk_tracking_json(replay),
            "text": reproduce.cuhk_tracking_text(replay),
            "repr": [repr(replay)],
        }

    return once(shared_folder, f"tracking {request.param}", make)
