"""Each replay runs once in a process, for all that is tested about it."""

import numpy as np
import pytest
from html_pages import check

from exoid import reproduce
from exoid.lab.reproduce.tracking_report import cuhk_tracking_report
from exoid.view.style import write_figures


def shown(report, folder):
    """What a report prints, writes and draws."""
    figures = write_figures(folder, report.figures(), ["png"])
    return {"json": report.data, "text": str(report), "page": report.page().html(), "figures": figures}


@pytest.fixture(scope="session")
def bleex(tmp_path_factory):
    """The default replay of document 1, as the command line runs it."""
    replay = reproduce.reproduce_bleex()[0]
    band = {side: getattr(replay, side).data.upright.band.mean(axis=0) for side in ("left", "right")}
    return shown(reproduce.bleex_report(replay), tmp_path_factory.mktemp("bleex")) | {"band": band}


@pytest.fixture(scope="session")
def cuhk(tmp_path_factory):
    """A replay of document 2 of half the time, in which its figures are as sharp as they are tested to be."""
    replay = reproduce.reproduce_cuhk(duration=30.0)[0]
    size = np.ptp(replay.measured, axis=0)
    return shown(reproduce.cuhk_report(replay), tmp_path_factory.mktemp("cuhk")) | {"range": size}


@pytest.fixture(
    scope="session",
    params=[pytest.param(rotor, marks=pytest.mark.nightly) for rotor in (0.8, 0.0)],
    ids=lambda rotor: f"rotor {rotor}",
)
def tracking(request):
    """Document 2's comparison of controllers with every law, with rotors and without; notebook 5 asserts it, too."""
    replay = reproduce.reproduce_cuhk_tracking(0, request.param)
    report = cuhk_tracking_report(replay)
    return {"json": report.data, "text": str(report), "estimate": replay.estimate}


@pytest.fixture(scope="session")
def check_page():
    """A page is valid, has every figure, and says what the printed tables say."""

    def checked(replay, title, pictures):
        tree = check(replay["page"])
        assert len(list(tree.iter("img"))) == pictures
        assert title in tree.findtext(".//h1")
        words = " ".join(replay["text"].split())
        for cell in (*tree.iter("td"), *tree.iter("th"), *tree.iter("li")):
            assert (cell.text or "") in words

    return checked
