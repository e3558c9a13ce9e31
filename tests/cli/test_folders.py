"""Folders of logs and bags on the command line."""

from pathlib import Path

import pytest
from log_writers import messages, write_bag

import exoid
from exoid.cli import folders
from exoid.cli.inputs import read_log
from exoid.signals.recordings import logs_in


@pytest.fixture
def folder(tmp_path):
    """Three logs, the last of which comes after the second in numbers only."""
    data, path = exoid.datasets.bleex_swing(), tmp_path / "logs"
    path.mkdir()
    for number, start in ((1, 0), (2, 900), (10, 1800)):
        data.train.slice(start, start + 900).to_csv(path / f"part.{number}.csv")
    return path


def test_logs_of_a_folder_are_read_for_the_fit_alone(exoid_, folder, monkeypatch):
    """All were held in memory at once before, to look for the motion of a base that nobody asked for."""
    read, names = [], [path.name for path in logs_in(folder)]
    monkeypatch.setattr(folders, "read_log", lambda name, how: read.append(Path(name).name) or read_log(name, how))
    assert exoid_("identify", "bleex", "logs", "--no-check", "--cutoff", 8).code == 0
    assert read == ["part.1.csv", *names, *names]  # the first says which joints; a summary, then the rows


def test_a_folder_stands_for_its_logs(exoid_, folder):
    found = exoid_("identify", "bleex", "logs", "--no-check", "--json").data
    assert [one["name"] for one in found["inputs"]] == ["part.1.csv", "part.2.csv", "part.10.csv"]
    files = [folder / f"part.{number}.csv" for number in (1, 2, 10)]
    assert found["values"] == exoid_("identify", "bleex", *files, "--no-check", "--json").data["values"]


def test_the_topic_and_the_stamps_of_a_bag_are_options(exoid_, tmp_path):
    recording = exoid.datasets.bleex_swing().train.slice(0, 1000)
    write_bag(tmp_path / "bag", {"/left": messages(recording), "/right": messages(recording)}, late=10**6)
    assert "exoid: bag: 2 topics of joint states: /left, /right" in exoid_("identify", "bleex", "bag").refusal
    assert exoid_("identify", "bleex", "bag", "--no-check", "--topic", "/right", "--received")[0] == 0
    recording.to_csv(tmp_path / "log.csv")
    assert exoid_("identify", "bleex", "log.csv", "--topic", "/right").refusal
