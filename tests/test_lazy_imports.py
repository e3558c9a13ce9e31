"""Names of ``exoid`` are imported when they are first used, each in an interpreter that has seen nothing else."""

import ast
import re
from pathlib import Path

import pytest
from processes import run_python

import exoid


def top_level(program):
    """Top-level packages that a program has imported when it ends."""
    return set(run_python(f"{program}\nimport sys; print(*{{name.partition('.')[0] for name in sys.modules}})").split())


def test_importing_exoid_imports_nothing_but_its_table_of_contents():
    brought = top_level("import exoid") - top_level("import lazy_loader, ast")
    assert brought == {"exoid"}


def test_a_leg_and_its_identification_import_what_they_compute_with_and_no_more():
    imported = top_level("import exoid; exoid.load_leg('bleex'); exoid.identify; exoid.Recording")
    assert {"pinocchio", "numpy", "scipy"} <= imported
    unused = {"jinja2", "matplotlib", "meshcat", "multiprocessing", "polars", "pooch", "rich", "rosbags", "tornado"}
    assert not imported & (unused | {"trimesh", "typer", "yourdfpy", "distributed", "threadpoolctl"})


def test_an_identification_imports_no_part_of_scipy_that_it_does_not_use():
    parts = run_python("import exoid, sys; exoid.identify, exoid.load_leg('cuhk'); print(*sys.modules)").split()
    assert not {"scipy.optimize", "scipy.stats", "scipy.signal", "scipy.interpolate"} & set(parts)


@pytest.mark.slow
def test_the_leg_in_three_dimensions_needs_no_matplotlib_and_trimesh_for_meshes_only():
    imported = top_level("import exoid; exoid.view.scene(exoid.load_leg('bleex'))")
    assert "pinocchio" in imported
    assert not imported & {"matplotlib", "meshcat", "trimesh", "yourdfpy"}


def test_nothing_below_the_command_line_imports_the_table_of_contents():
    """It stands above all packages: to import it from one of them would close a circle."""
    package = Path(exoid.__file__).parent
    upward = re.compile(r"^\s*(from exoid import|import exoid\b)", re.MULTILINE)
    sideways = re.compile(r"^\s*from \. import", re.MULTILINE)
    for path in package.rglob("*.py"):
        if path.parent != package / "cli":
            text = path.read_text(encoding="utf-8")
            assert not upward.search(text), path
            assert path.parent != package or not sideways.search(text), path


@pytest.mark.parametrize("package", [exoid, exoid.view])
def test_type_checkers_and_python_read_the_same_table_of_contents(package):
    stub = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    (listed,) = (node.value for node in stub.body if isinstance(node, ast.Assign))
    assert ast.literal_eval(listed) == package.__all__ == dir(package)
