"""Meshes of every format are read with their colours; names and files that are not as they should be become notes."""

import re

import numpy as np
import pytest
import trimesh
from drawings import SHANK, leg_with, mesh_visual, meshes, objects

from exoid import ExoidError
from exoid.view import scene
from exoid.view.scenes.meshes import MAX_TRIANGLES, read_mesh

RED, BLUE = (200, 30, 40), (10, 60, 220)


def two_boxes():
    """A red box above a blue one, of materials that files can hold."""
    parts = trimesh.Scene()
    for name, colour, height in (("upper", RED, 0.3), ("lower", BLUE, 0.0)):
        part = trimesh.creation.box((0.1, 0.2, 0.3), trimesh.transformations.translation_matrix((0.0, 0.0, height)))
        part.visual = trimesh.visual.TextureVisuals(
            uv=np.zeros((8, 2)), material=trimesh.visual.material.PBRMaterial(name, baseColorFactor=(*colour, 255))
        )
        parts.add_geometry(part, geom_name=name)
    return parts


def hexadecimal(colour):
    return "#{:02x}{:02x}{:02x}".format(*colour)


def write(path, parts):
    """Write meshes, with a file of materials where the format has one."""
    if path.suffix == ".dae":
        path.write_bytes(trimesh.exchange.dae.export_collada(parts.dump()))
    else:
        parts.export(path)


@pytest.mark.parametrize("ending", ["obj", "dae", "glb", "stl", "ply"])
def test_every_format_is_read_in_its_place_and_colours(ending, tmp_path):
    write(tmp_path / f"leg.{ending}", two_boxes())
    found = read_mesh(str(tmp_path / f"leg.{ending}"), [2.0, 1.0, -1.0])
    points = np.vstack([mesh.points for mesh in found])
    np.testing.assert_allclose(points.min(axis=0), [-0.1, -0.1, -0.45], atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), [0.1, 0.1, 0.15], atol=1e-6)
    if ending in ("obj", "dae", "glb"):
        assert {mesh.colour for mesh in found} == {hexadecimal(RED), hexadecimal(BLUE)}
    if ending == "stl":
        assert [mesh.colour for mesh in found] == [None]


@pytest.mark.parametrize(
    ("material", "colours"),
    [
        ("", {hexadecimal(RED), hexadecimal(BLUE)}),
        ('<material name="unknown"/>', {hexadecimal(RED), hexadecimal(BLUE)}),
        ('<material name="green"/>', {"#00ff00"}),
        ('<material name=""><color rgba="1 1 0 1"/></material>', {"#ffff00"}),
    ],
)
def test_a_material_of_the_urdf_comes_before_the_colours_of_the_file(material, colours, tmp_path):
    write(tmp_path / "shank.glb", two_boxes())
    green = '<material name="green"><color rgba="0 1 0 1"/></material>'
    drawn = scene(leg_with(mesh_visual("shank.glb", material), green), meshes=tmp_path)
    assert drawn.notes == ()
    assert {f"#{material['color']:06x}" for _, material, _ in meshes(objects(drawn)[SHANK])} == colours


def test_a_mesh_takes_no_material_from_outside_of_its_folder(tmp_path):
    (tmp_path / "leg").mkdir()
    write(tmp_path / "leg" / "shank.obj", two_boxes())
    assert (tmp_path / "leg" / "material.mtl").rename(tmp_path / "secret.mtl").is_file()
    text = (tmp_path / "leg" / "shank.obj").read_text(encoding="utf-8")
    (tmp_path / "leg" / "shank.obj").write_text(text.replace("material.mtl", "../secret.mtl"), encoding="utf-8")
    found = read_mesh(str(tmp_path / "leg" / "shank.obj"), [1.0, 1.0, 1.0])
    assert not {hexadecimal(RED), hexadecimal(BLUE)} & {mesh.colour for mesh in found}


def test_a_mesh_of_many_triangles_is_simplified_and_keeps_its_shape(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    ball.export(tmp_path / "ball.stl")
    (found,) = read_mesh(str(tmp_path / "ball.stl"), [1.0, 1.0, 1.0])
    assert len(found.triangles) <= MAX_TRIANGLES < len(ball.faces)
    np.testing.assert_allclose(np.linalg.norm(found.points, axis=1), 0.1, rtol=1e-6)
    smaller = trimesh.Trimesh(found.points, found.triangles)
    assert smaller.volume == pytest.approx(ball.volume, rel=5e-3)


@pytest.mark.parametrize("index", [-1, 3, 2**31 - 1])
def test_triangles_of_vertices_that_do_not_exist_are_refused(index, tmp_path):
    """Found by mutated PLY files."""
    text = trimesh.exchange.ply.export_ply(trimesh.Trimesh(np.eye(3), [[0, 1, 2], [0, 2, 1]], process=False), "ascii")
    (tmp_path / "a.ply").write_text(text.decode().replace("3 0 2 1", f"3 0 1 {index}"))
    with pytest.raises(ExoidError, match="cannot be read as a mesh: triangles of vertices that do not exist"):
        read_mesh(str(tmp_path / "a.ply"), [1.0, 1.0, 1.0])


NO_MESHES = (
    "http://example.com/shank.stl",
    "https://example.com/shank.stl",
    "C:\\exo\\gone.stl",
    "",
    "fold",
    "broken.stl",
)


@pytest.mark.parametrize("filename", NO_MESHES)
def test_names_that_lead_to_no_mesh_become_a_bar_and_a_note(filename, tmp_path):
    (tmp_path / "fold").mkdir()
    (tmp_path / "broken.stl").write_text("this is not a mesh")
    drawn = scene(leg_with(mesh_visual(filename)), meshes=tmp_path)
    (note,) = drawn.notes
    assert "left_shank" in note
    assert "BoxGeometry" in {geometry["type"] for geometry, _, _ in meshes(objects(drawn)[SHANK])}


BALL = '<geometry><sphere radius="1"/></geometry>'
NO_NUMBERS = {
    "<box size='1 2'>": '<visual><geometry><box size="1 2"/></geometry></visual>',
    "<sphere radius=None>": "<visual><geometry><sphere/></geometry></visual>",
    "<origin rpy='0 inf 0'>": f'<visual><origin rpy="0 inf 0"/>{BALL}</visual>',
    "<color rgba='1 1 1'>": f'<visual>{BALL}<material><color rgba="1 1 1"/></material></visual>',
    "plausible": mesh_visual('a.stl" scale="1e300 1 1'),
}


@pytest.mark.parametrize("said", NO_NUMBERS)
def test_numbers_of_a_visual_that_are_none_are_one_error(said):
    with pytest.raises(ExoidError, match=re.escape(said)) as error:
        scene(leg_with(NO_NUMBERS[said]))
    assert "left_shank" in str(error.value)
