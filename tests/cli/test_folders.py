"""Folders of logs on the command line."""

import json
from pathlib import Path

import pytest

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
    code, out, _ = exoid_("identify", "bleex", "logs", "--no-check", "--json")
    assert code == 0
    assert [one["name"] for one in json.loads(out)["inputs"]] == ["part.1.csv", "part.2.csv", "part.10.csv"]
    files = [folder / f"part.{number}.csv" for number in (1, 2, 10)]
    _, alone, _ = exoid_("identify", "bleex", *files, "--no-check", "--json")
    assert json.loads(out)["values"] == json.loads(alone)["values"]
