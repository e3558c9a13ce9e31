"""``exoid reproduce``: the same seed gives the same bytes, and bad folders are refused before anything runs."""

import json
from functools import partial

import pytest

from exoid import reproduce

SHORT = reproduce.Extent(duration=5.0, poses=20)


@pytest.fixture
def command(exoid_, monkeypatch):
    """Run ``exoid reproduce ARGUMENTS`` on short replays, in an empty folder."""
    monkeypatch.setattr(reproduce, "reproduce_bleex", partial(reproduce.reproduce_bleex, extent=SHORT))
    monkeypatch.setattr(reproduce, "reproduce_cuhk", partial(reproduce.reproduce_cuhk, duration=6.0))
    return partial(exoid_, "reproduce")


@pytest.mark.nightly
def test_the_same_seed_gives_the_same_bytes(command, tmp_path):
    done = command("bleex", "--json", "--seed", 3, "--figures", "new/folder")
    assert done.data["seed"] == 3
    assert done.err.count("wrote") == 10
    assert len(list((tmp_path / "new/folder").glob("*.pdf"))) == 5
    assert len(list((tmp_path / "new/folder").glob("*.svg"))) == 5
    again = reproduce.bleex_report(reproduce.reproduce_bleex(3)[0]).data
    assert json.dumps(again, indent=1) + "\n" == done.out


@pytest.mark.nightly
def test_tables_are_printed_and_a_report_is_written_beside_them(command, tmp_path):
    out = command("cuhk", "--seed", 1, "--report", "cuhk.html").printed
    assert out.startswith("On an independent motion")  # findings first
    assert "\nCUHK-EXO, Tables II and III" in out
    assert "document 2 replayed" in (tmp_path / "cuhk.html").read_text()


@pytest.mark.parametrize("report", ["missing/report.html", "."])
def test_a_report_that_cannot_be_written_is_refused_before_anything_runs(report, command, monkeypatch):
    monkeypatch.setattr(reproduce, "reproduce_bleex", lambda *_, **__: pytest.fail("it ran"))
    assert "cannot be written" in command("bleex", "--report", report).refusal


@pytest.mark.parametrize("document", ["bleex", "cuhk"])
def test_a_bad_folder_is_refused_before_anything_runs(document, command, tmp_path, monkeypatch):
    monkeypatch.setattr(reproduce, f"reproduce_{document}", lambda *_, **__: pytest.fail("it ran"))
    (tmp_path / "file").write_text("mine")
    assert command(document, "--figures", tmp_path / "file").refusal
    assert (tmp_path / "file").read_text() == "mine"
