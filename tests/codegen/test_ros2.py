"""The package for ROS 2 compiles against stub headers; its controller and node command what the law in Python does."""

import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from compiled import COMPILER
from laws_of_bleex import laws, torques_in_python
from processes import run

import exoid
from exoid import ExoidError
from exoid.codegen import Safety, c_source, write_ros2

CPP = shutil.which("g++")
STUBS = Path(__file__).parent / "ros2_stubs"
STRICT = ("-std=c++17", "-Wall", "-Wextra", "-Werror", "-pedantic")

pytestmark = pytest.mark.skipif(CPP is None or COMPILER is None, reason="needs g++")

NAMES = ("gravity_friction_pd", "lqr", "sensitivity_amplification")
"""A law with limits, one with accelerations, and one with memory and without a reference."""

KINDS = {"gravity_friction_pd": ("q_d", "v_d"), "lqr": ("q_d", "v_d", "a_d"), "sensitivity_amplification": ()}

OK, NOT_FINITE, STALE, TARGET_NOT_FINITE, TARGET_STALE = range(5)

SAMPLES = 120


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Build the package of a law once, in a folder of its own, and a program that runs it."""

    @cache
    def build(name):
        folder = tmp_path_factory.mktemp(name) / "leg"
        package = write_ros2(folder, laws()[name])
        objects = folder.parent / "leg.o"
        include = (f"-I{folder / 'include'}", f"-I{STUBS}")
        run(COMPILER, "-std=c99", "-Wall", "-Wextra", "-Werror", "-c", *include, folder / "src/leg.c", "-o", objects)
        controller, node = (f'#include "{folder}/src/{name}.cpp"' for name in ("controller", "joint_state_node"))
        whole = folder.parent / "whole.cpp"  # the headers are read once; the node's own program is not run
        whole.write_text("\n".join((controller, "#define main program", node, "#undef main", '#include "run.cpp"', "")))
        run(CPP, *STRICT, *include, whole, objects, "-o", folder.parent / "run")
        return package, folder.parent / "run"

    return build


@pytest.fixture(scope="module")
def recorded():
    """A recording of a swing as measurement, and what it was to be as reference."""
    recording = exoid.datasets.bleex_swing().train
    q, time = np.asarray(recording.q)[:SAMPLES], np.asarray(recording.time)[:SAMPLES]
    v = np.gradient(q, time, axis=0)
    return {"q": q, "v": v, "q_d": q + 0.05, "v_d": 0.9 * v, "a_d": np.gradient(v, time, axis=0)}


def rows_of(name, values):
    """Rows of the program: measurement, reference, counter, and that both are written."""
    count = np.arange(1.0, SAMPLES + 1.0)
    references = [values[kind] for kind in KINDS[name]]
    ones = np.ones((SAMPLES, 2))
    return np.hstack([values["q"], values["v"], *references, count[:, None], ones])


def executed(program, mode, rows, *parameters):
    """Torques, statuses and faults."""
    table, out = program.with_name("in.bin"), program.with_name("out.bin")
    np.ascontiguousarray(rows).tofile(table)
    run(program, mode, table, out, *(parameters or ("ramp_time=0",)))
    found = np.fromfile(out).reshape(len(rows), 5)
    return found[:, :3], found[:, 3].astype(int), found[:, 4]


@pytest.mark.nightly
@pytest.mark.parametrize("mode", ["chained", "topic", "node"])
@pytest.mark.parametrize("name", NAMES)
def test_controller_and_node_command_what_python_does(built, recorded, name, mode):
    tau, status, faults = executed(built(name)[1], mode, rows_of(name, recorded))
    expected = torques_in_python(laws()[name], recorded)
    np.testing.assert_allclose(tau, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    if mode != "node":
        assert not status.any()
        assert not faults.any()


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["chained", "topic"])
def test_a_reference_that_stops_gives_the_safe_torque_after_50_ms_and_the_law_comes_back(built, recorded, mode):
    rows = rows_of("gravity_friction_pd", recorded)
    rows[30:60, -1] = 0.0
    _, status, _ = executed(built("gravity_friction_pd")[1], mode, rows)
    expected = np.zeros(SAMPLES, int)
    expected[35:60] = TARGET_STALE
    assert status.tolist() == expected.tolist()


@pytest.mark.slow
def test_the_node_sees_stamps_that_stand_still_and_messages_that_stop(built, recorded):
    rows = rows_of("sensitivity_amplification", recorded)
    rows[30:60, -3] = rows[29, -3]
    rows[80:110, -2] = 0.0
    tau, _, _ = executed(built("sensitivity_amplification")[1], "node", rows)
    patience = Safety().steps(200.0)
    assert patience == 10
    assert not tau[30 + patience : 60].any()
    assert not tau[80 + patience : 110].any()
    assert tau[25:35].all()
    assert tau[65:85].all()


@pytest.mark.slow
def test_parameters_lower_the_torque_and_raise_it_slowly(built, recorded):
    rows = rows_of("lqr", recorded)
    program = built("lqr")[1]
    whole = executed(program, "chained", rows)[0]
    limit = 0.5 * np.abs(whole).max(axis=0)
    limited = executed(program, "chained", rows, "ramp_time=0", f"torque_limit={','.join(map(repr, limit.tolist()))}")
    np.testing.assert_array_equal(limited[0], np.clip(whole, -limit, limit))
    rising = executed(program, "chained", rows, "ramp_time=0.5")[0]
    ramp = np.minimum(np.arange(SAMPLES) / 50.0, 1.0)[:, None]
    np.testing.assert_allclose(rising, ramp * whole, rtol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parameter", "words"),
    [
        ("update_rate=200", "written for 100 Hz, and is updated at 200 Hz"),
        ("torque_limit=1,2", "torque_limit: give 3 numbers"),
        ("torque_limit=1,2,-3", "torque_limit: give 3 numbers"),
        ("torque_limit=1,2,nan", "torque_limit: give 3 numbers"),
        ("ramp_time=-1", "ramp_time: give a time"),
        ("joints=1,2,3", "joints: give 3 different names"),
    ],
)
def test_bad_parameters_are_refused_before_anything_moves(built, tmp_path, parameter, words):
    (tmp_path / "in.bin").touch()
    command = [built("lqr")[1], "configure", tmp_path / "in.bin", tmp_path / "out.bin", parameter]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, words in done.stderr) == (3, True), done.stderr


@pytest.mark.slow
def test_the_program_of_the_node_compiles_and_single_precision_too(tmp_path):
    folder = tmp_path / "Left-Leg"
    package = write_ros2(folder, laws()["gravity_support"], precision="float")
    assert package.prefix == "left_leg"
    for source in ("controller.cpp", "joint_state_node.cpp"):
        include = (f"-I{folder / 'include'}", f"-I{STUBS}")
        run(CPP, *STRICT, "-fsyntax-only", *include, folder / "src" / source)


def test_xml_cmake_and_parameters_name_the_same_things(tmp_path):
    write_ros2(tmp_path / "leg", laws()["gravity_friction_pd"])
    package, plugin = (ET.parse(tmp_path / "leg" / name).getroot() for name in ("package.xml", "plugin.xml"))
    cmake = (tmp_path / "leg/CMakeLists.txt").read_text()
    assert package.findtext("name") == plugin.get("path") == re.search(r"project\((\w+)", cmake).group(1) == "leg"
    listed = re.search(r"set\(DEPENDENCIES(.*?)\)", cmake, re.DOTALL).group(1).split()
    assert sorted(listed) == sorted(each.text for each in package.findall("depend"))
    assert plugin.find("class").get("type") == "leg_ros2::Controller"
    parameters = (tmp_path / "leg/config/controllers.yaml").read_text()
    assert "type: leg/Controller" in parameters
    assert plugin.find("class").get("name") == "leg/Controller"
    assert "torque_limit: [150.0, 125.0, 90.0]" in parameters
    for source in re.findall(r"src/\S+?\.c(?:pp)?", cmake):
        assert (tmp_path / "leg" / source).is_file()
    included = {
        name
        for path in (tmp_path / "leg").rglob("*.[hc]pp")
        for name in re.findall(r'#include "(\w+)/', path.read_text())
    }
    assert included - {"leg"} <= set(listed)


def test_the_folder_is_written_whole_and_never_over_other_files(tmp_path):
    folder, law = tmp_path / "leg", laws()["gravity_friction_pd"]
    folder.mkdir()
    write_ros2(folder, law)
    write_ros2(folder, laws()["lqr"])  # over an unchanged export
    assert "K (x_d - x)" in (folder / "README.md").read_text()
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(ExoidError, match=r"did not write, or that were changed: notes\.txt"):
        write_ros2(folder, law)
    (folder / "notes.txt").unlink()
    yaml = folder / "config/controllers.yaml"
    yaml.write_text(yaml.read_text().replace("2.0", "5.0"))
    with pytest.raises(ExoidError, match=r"config/controllers\.yaml"):
        write_ros2(folder, law)
    assert "K (x_d - x)" in (folder / "README.md").read_text()
    assert [path.name for path in tmp_path.iterdir()] == ["leg"]


def test_the_description_has_the_files_and_its_c_is_that_of_the_law(tmp_path):
    law = laws()["lqr"]
    package = write_ros2(tmp_path / "leg", law)
    assert json.loads((tmp_path / "leg/exoid.json").read_text()) == package.to_json()["files"]
    source = c_source(law, name="leg")
    assert (tmp_path / "leg/include/leg/leg.h").read_text() == source.header
    assert (tmp_path / "leg/src/leg.c").read_text().replace("leg/leg.h", "leg.h") == source.text
