"""A package that is only installed works in every step, each in an interpreter of its own that never imports it."""

from __future__ import annotations

import json
import re
import shutil

import numpy as np
import pytest
from springs import COMPILED, PROJECT, STIFFNESS, command, run, write_metadata

pytestmark = pytest.mark.slow

FRESH = """
import json, sys
import numpy as np
import exoid
from exoid.leg.exported import parameter_terms, read_exported
from exoid.rig import Plant

est = exoid.Estimate.load("est.json")
assert [type(term).__name__ for term in est.model.terms] == ["Coulomb", "Viscous", "EndStop"]
est.save("again.json")

export = est.to_urdf("leg.urdf")
assert export.only_in_sidecar == ("k_hip", "k_knee"), export.only_in_sidecar
leg, resistances, offsets = read_exported("leg.urdf")
for joint in ("hip", "knee"):
    for symbol in ("c0", "d", "k"):
        assert resistances[f"{symbol}_{joint}"] == est.value(f"{symbol}_{joint}")
assert parameter_terms("leg.urdf")["k_knee"] == "end-stop"
try:
    Plant.from_urdf("leg.urdf")
except exoid.ExoidError as error:
    print(error)
plant = Plant.from_urdf("leg.urdf", without=("end-stop",))
assert plant.coulomb[1, 0] == est.value("c0_knee")

q, v, a = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 200, 2))
print(json.dumps(est.torque(q, v, a).tolist()))
if sys.argv[1] == "compile":
    import pathlib
    from compiled import CompiledLeg
    source = est.to_c("leg.c")
    c = CompiledLeg(source, pathlib.Path("build"))
    difference = np.abs(c("inverse_dynamics", q, v, a) - est.torque(q, v, a)).max()
    assert difference < 1e-12 * np.abs(est.torque(q, v, a)).max(), difference
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory, recording):
    """A folder in which the command has identified a leg by all the package offers."""
    folder = tmp_path_factory.mktemp("work")
    write_metadata(folder / "site")
    recording.to_csv(folder / "log.csv")
    options = ("--terms", "coulomb,viscous,end-stop", "--estimator", "mad")
    done = command(
        "identify", "cuhk", "log.csv", *options, "-o", "est.json", "--report", "report.html", "--test", "log.csv",
        path=installed(folder), cwd=folder,
    )  # fmt: skip
    (folder / "printed").write_text(done.stdout, encoding="utf-8")
    return folder


def installed(folder):
    """Path of an interpreter in which the package is installed."""
    return folder / "site", PROJECT


def saved(folder, name="est.json"):
    return json.loads((folder / name).read_text(encoding="utf-8"))


def test_the_command_line_identifies_by_installed_names(folder):
    printed, data = (folder / "printed").read_text(encoding="utf-8"), saved(folder)
    assert "cuhk.urdf: mad estimate of 12 parameters" in printed
    assert re.search(r"from log\.csv \(\d+ samples\)", printed)
    for joint, stiffness in STIFFNESS.items():
        assert data["values"][f"k_{joint}"] == pytest.approx(stiffness, rel=0.01)
    assert data["terms"][2] == {
        "term": "end-stop",
        "from": "exoid_springs.end_stop",
        "joints": None,
        "onset": 0.3,
        "power": 2,
        "sides": ["lower", "upper"],
    }
    assert data["terms"][0] == {
        "term": "coulomb", "joints": None, "smoothing": 0.02, "presliding": 0.0, "dead_band": 0.0,
        "reversal_speed": 0.0, "asymmetric": False,
    }  # fmt: skip
    assert data["estimator"] == "mad"
    assert data["inputs"][0]["name"] == "log.csv"


def test_a_fresh_interpreter_loads_exports_and_reads_back(folder):
    compiler = "compile" if shutil.which("cc") else "no compiler"
    (folder / "build").mkdir(exist_ok=True)
    done = run("-c", FRESH, compiler, path=(*installed(folder), COMPILED), cwd=folder)
    refusal, torque = done.stdout.splitlines()
    assert "the rig has no k_hip of the term end-stop, k_knee of the term end-stop" in refusal
    assert "without=('end-stop',) to simulate the leg without it" in refusal
    assert np.isfinite(json.loads(torque)).all()
    assert (folder / "again.json").read_bytes() == (folder / "est.json").read_bytes()
    sidecar = saved(folder, "leg.exoid.json")
    assert sidecar["terms"] == saved(folder)["terms"]
    assert sidecar["only_here"] == ["k_hip", "k_knee"]
    urdf = (folder / "leg.urdf").read_text(encoding="utf-8")
    for name, attribute in (("c0_knee", "friction"), ("d_knee", "damping")):
        assert f'{attribute}="{saved(folder)["values"][name]!r}"' in urdf


@pytest.mark.nightly
def test_a_broken_package_is_named_where_it_is_needed_and_nowhere_else(folder, tmp_path):
    offers = {
        f"exoid.{group}": {name: "broken_springs:THING"} for group, name in (("terms", "bent"), ("estimators", "bent"))
    }
    write_metadata(tmp_path, "broken-springs", "0.1", offers)
    (tmp_path / "broken_springs.py").write_text("raise RuntimeError('no licence')", encoding="utf-8")
    path = (tmp_path, *installed(folder))
    for options in (("--terms", "bent"), ("--estimator", "bent")):
        done = command("identify", "cuhk", str(folder / "log.csv"), *options, path=path, cwd=tmp_path, code=2)
        assert "'bent' of broken-springs 0.1 (broken_springs:THING) cannot be loaded: RuntimeError: no licence" in (
            done.stderr
        )
        assert done.stderr.count("\n") == 1
    shown = command("identify", "--help", path=path, cwd=tmp_path).stdout
    assert "armature" in shown
    assert "bent" not in shown  # help looks at no installed package
    assert "R²" in command("validate", folder / "est.json", folder / "log.csv", path=path, cwd=tmp_path).stdout
