"""No verb writes over what it reads, or into what is no file."""

import shutil
from pathlib import Path

import pytest

import exoid

IDENTIFY = ("identify", "leg.urdf", "logs/log.csv", "--joints", "left_hip,left_knee,left_ankle")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory, data):
    """A folder with a URDF, a log and an estimate."""
    folder = tmp_path_factory.mktemp("inputs")
    (folder / "leg.urdf").write_bytes((exoid.catalog.urdf_folder() / "bleex.urdf").read_bytes())
    (folder / "logs").mkdir()
    data.train.to_csv(folder / "logs" / "log.csv")
    exoid.identify(exoid.Leg.from_urdf(folder / "leg.urdf", data.train.joint_names), data.train).save(
        folder / "est.json"
    )
    shutil.copy(folder / "est.json", folder / "other.json")
    return folder


@pytest.fixture
def run(inputs, tmp_path, exoid_):
    """Run a verb beside copies of the inputs; return the line on standard error after it was refused with status 2."""
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)

    def _run(*words):
        before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
        line = exoid_(*words).refusal
        assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
        return line

    return _run


@pytest.mark.parametrize(
    ("words", "file"),
    [
        ((*IDENTIFY, "-o", "logs/log.csv"), "logs/log.csv"),
        ((*IDENTIFY, "--report", "leg.urdf"), "leg.urdf"),
        ((*IDENTIFY, "--test", "est.json", "--report", "est.json"), "est.json"),
        (("identify", "leg.urdf", "logs", "-o", "logs/log.csv"), "logs/log.csv"),
        (("select", "leg.urdf", "logs/log.csv", "-o", "logs/log.csv"), "logs/log.csv"),
        (("export", "est.json", "-o", "leg.urdf"), "leg.urdf"),
        (("export", "est.json", "--c", "est.json"), "est.json"),
        (("view", "leg.urdf", "--log", "logs/log.csv", "--html", "logs/log.csv"), "logs/log.csv"),
        (("plan", "leg.urdf", "--assess", "logs/log.csv", "--figures", "logs/log.csv"), "logs/log.csv"),
        (("track", "est.json", "--reference", "logs/log.csv", "--report", "logs/log.csv"), "logs/log.csv"),
        (("validate", "est.json", "logs/log.csv", "--report", "logs/log.csv"), "logs/log.csv"),
        (("compare", "est.json", "other.json", "--figures", "est.json"), "est.json"),
    ],
)
def test_an_output_that_is_an_input_is_refused_before_anything_is_read(run, words, file):
    line = run(*words)
    assert f"{file}: is an input" in line
    assert "give the output another name" in line


def test_two_outputs_have_two_names(run):
    assert "name one file" in run(*IDENTIFY, "-o", "new.html", "--report", "./new.html")


@pytest.mark.parametrize(
    "words",
    [
        (*IDENTIFY, "-o", "none/est.json"),
        (*IDENTIFY, "--report", "none/report.html"),
        ("select", "leg.urdf", "logs/log.csv", "-o", "none/est.json"),
        ("plan", "leg.urdf", "-o", "none/plan.csv"),
        ("plan", "leg.urdf", "-o", "plan.csv", "--figures", "leg.urdf/drawn"),
        ("view", "leg.urdf", "--html", "none/leg.html"),
    ],
)
def test_rights_are_checked_before_the_work(run, words, monkeypatch):
    def work(*_, **__):
        raise AssertionError("the work began")

    for name in ("exoid.Recording.from_file", "exoid.Leg.from_urdf"):
        monkeypatch.setattr(name, work)
    assert "cannot" in run(*words)
    assert not list(Path().glob("plan*"))
