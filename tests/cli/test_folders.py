"""Folders of logs on the command line."""

import json

import pytest

import exoid


@pytest.fixture
def folder(tmp_path):
    """Three logs, the last of which comes after the second in numbers only."""
    data, path = exoid.datasets.bleex_swing(), tmp_path / "logs"
    path.mkdir()
    for number, start in ((1, 0), (2, 900), (10, 1800)):
        data.train.slice(start, start + 900).to_csv(path / f"part.{number}.csv")
    return path


def test_a_folder_stands_for_its_logs(exoid_, folder):
    code, out, _ = exoid_("identify", "bleex", "logs", "--no-check", "--json")
    assert code == 0
    assert [one["name"] for one in json.loads(out)["inputs"]] == ["part.1.csv", "part.2.csv", "part.10.csv"]
    files = [folder / f"part.{number}.csv" for number in (1, 2, 10)]
    _, alone, _ = exoid_("identify", "bleex", *files, "--no-check", "--json")
    assert json.loads(out)["values"] == json.loads(alone)["values"]
