"""Links are drawn by their URDF; meshes are found, or become a note."""

import json
import re
import warnings

import numpy as np
import pytest
import trimesh
from drawings import SHANK, leg_with, mesh_visual, meshes, objects

import exoid
from exoid import Leg
from exoid.leg.description import describe
from exoid.view import scene
from exoid.view.scenes.mesh_search import find_mesh


def test_a_cylinder_is_drawn_along_its_z_axis():
    """URDF's cylinders are along z, three.js's along y."""
    text = exoid.load_leg("bleex").description.text
    cylinder = '<visual><geometry><cylinder radius="0.01" length="0.4"/></geometry></visual>'
    text = re.sub(
        r'(<link name="left_foot">).*?(<inertial>.*?</inertial>).*?</link>',
        rf"\1\2{cylinder}</link>",
        text,
        flags=re.DOTALL,
    )
    leg = Leg.from_description(describe(text), ("left_hip", "left_knee", "left_ankle"))
    ((geometry, _, place),) = meshes(
        objects(scene(leg))["/exoid/left leg/left_hip/body/left_knee/body/left_ankle/body/shape"]
    )
    assert geometry["height"] == 0.4
    np.testing.assert_allclose(np.abs(place[:3, 1]), [0.0, 0.0, 1.0], atol=1e-12)


def write_ball(path):
    trimesh.creation.icosphere(subdivisions=1, radius=0.1).export(path)


@pytest.mark.parametrize("filename", ["meshes/shank.stl", "package://my_exo/meshes/shank.stl"])
def test_meshes_are_found_beside_the_urdf_and_in_its_package(filename, tmp_path):
    (tmp_path / "my_exo" / "meshes").mkdir(parents=True)
    (tmp_path / "my_exo" / "urdf").mkdir()
    write_ball(tmp_path / "my_exo" / "meshes" / "shank.stl")
    folder = tmp_path / "my_exo" / ("urdf" if filename.startswith("package") else "")
    drawn = scene(leg_with(mesh_visual(filename)), meshes=folder)
    ((geometry, _, _),) = meshes(objects(drawn)[SHANK])
    assert geometry["type"] == "BufferGeometry"
    assert drawn.notes == ()


def test_a_urdf_cannot_put_any_file_of_the_machine_into_a_page(tmp_path, monkeypatch):
    """Only files below the URDF's folder, and in packages, are found; others are named and left out."""
    monkeypatch.chdir(tmp_path)
    inside, outside = tmp_path / "leg", tmp_path / "secret.stl"
    (inside / "meshes").mkdir(parents=True)
    for file in (outside, inside / "meshes" / "a.stl"):
        write_ball(file)
    (inside / "link.stl").symlink_to(outside)
    for name in ("meshes/a.stl", "./meshes/../meshes/a.stl", f"file://{inside}/meshes/a.stl", "../meshes/a.stl"):
        assert find_mesh(name, inside).samefile(inside / "meshes" / "a.stl")
    root = str(tmp_path).strip("/").split("/", 1)
    names = [str(outside), f"file://{outside}", "../secret.stl", "link.stl", "package://leg/../secret.stl"]
    names.append("package://leg/link.stl")
    names += [f"package://{root[0]}/{root[1]}/secret.stl", "package://../secret.stl", "package:///secret.stl"]
    for name in names:
        with pytest.raises(FileNotFoundError, match=r"secret|link"):
            find_mesh(name, inside)
        drawn = scene(leg_with(mesh_visual(name)), meshes=inside)
        assert len(drawn.notes) == 1
        assert name in drawn.notes[0]


@pytest.mark.parametrize(
    ("value", "scale"), [("nan", "1 1 1"), ("1e39", "1 1 1"), ("0.1", "0 0 0"), ("0.1", "1e-300 1 1"), ("0.1", "0 1 1")]
)
def test_meshes_without_finite_size_become_a_note(value, scale, tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    text = trimesh.exchange.ply.export_ply(ball, encoding="ascii").decode()
    head, _, body = text.partition("end_header\n")
    (tmp_path / "bad.ply").write_text(f"{head}end_header\n{value} 0 0\n{body.partition(chr(10))[2]}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # as outside of the tests, where these warnings are no errors
        drawn = scene(leg_with(mesh_visual(f'bad.ply" scale="{scale}')), meshes=tmp_path)
    (note,) = drawn.notes
    assert "bad.ply" in note
    assert json.dumps(drawn.to_json(), allow_nan=False)
