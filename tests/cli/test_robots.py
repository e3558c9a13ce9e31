"""LEG may be the name of a robot of example-robot-data, which is imported only then."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from public_robots import urdf_of
from swings import harmonics

import exoid
from exoid.cli import robots


def log_of_ur5(path):
    """A short log of three joints of the arm."""
    joints = ("shoulder_lift_joint", "elbow_joint", "wrist_1_joint")
    leg = exoid.Leg.from_urdf(urdf_of("ur5"), joints)
    rng = np.random.default_rng(5)
    t = np.arange(4000) / 200.0
    w, size, phase = 2.0 * np.pi * 0.15 * np.arange(1, 5), *rng.uniform(0.1, 0.3, (2, 3, 4))
    q, v, a = harmonics(t, size, w, 20.0 * phase)
    tau = leg.inverse_dynamics(q, v, a) + 0.5 * np.tanh(v / 0.02) + 0.3 * v + rng.normal(scale=0.05, size=q.shape)
    exoid.Recording(time=t, q=q, tau=tau, joint_names=joints).to_csv(path)


def test_a_robot_is_identified_by_its_name(exoid_, tmp_path):
    log_of_ur5(tmp_path / "ur5.csv")
    by_name = exoid_("identify", "ur5", "ur5.csv", "--no-check", "--json")
    assert by_name.code == 0, by_name.err
    by_file = exoid_("identify", urdf_of("ur5"), "ur5.csv", "--no-check", "--json")
    assert by_name.out == by_file.out
    assert '"c0_elbow_joint"' in by_name.out


def test_a_file_of_that_name_goes_first(exoid_, tmp_path):
    log_of_ur5(tmp_path / "ur5.csv")
    (tmp_path / "ur5").write_text("<robot/>", encoding="utf-8")
    assert "ur5" in exoid_("identify", "ur5", "ur5.csv").err


def test_an_unknown_name_says_what_would_do(exoid_, monkeypatch):
    done = exoid_("identify", "panfa", "log.csv")
    assert done.code == 2
    assert "no leg or URDF file 'panfa'" in done.err
    assert "example-robot-data" in done.err
    for module in ("example_robot_data", "example_robot_data.robots_loader"):
        monkeypatch.setitem(sys.modules, module, None)  # not installed
    assert not robots.is_robot("panda")
    assert "pip install 'example-robot-data" in exoid_("identify", "panda", "log.csv").err


def test_robots_without_a_urdf_are_none():
    assert robots.is_robot("panda")
    assert not robots.is_robot("cassie")
    assert robots.urdf_of_robot("panda") == urdf_of("panda")


@pytest.mark.nightly
def test_a_robot_is_drawn_with_its_meshes(exoid_, tmp_path):
    done = exoid_("view", "panda", "--html", "panda.html")
    assert done.code == 0, done.err
    assert "not found" not in done.err
    assert (tmp_path / "panda.html").stat().st_size > 1e6


def test_the_package_is_imported_only_for_a_robots_name():
    script = (
        "import sys; from exoid.cli import legs, options; legs.find_leg('cuhk', options.LegOptions('left'), None); "
        "print(any(m.startswith('example_robot_data') for m in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
