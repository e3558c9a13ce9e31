"""exoid works wherever it was installed from: wheel, source distribution, editable."""

import ast
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
import zlib
from pathlib import Path

import processes
import pytest

import exoid

ROOT = Path(__file__).resolve().parents[2]
SOURCES = (
    *("exoid", "urdf", "tests", "scripts", "docs"),
    *("pyproject.toml", "README.md", "LICENSE", ".gitignore"),
    *("hatch_build.py",),
)
MORE_SOURCES = (
    *("BENCHMARKS.md", "CHANGELOG.md", "CONTRIBUTING.md"),
    *("CITATION.cff", ".zenodo.json", "mkdocs.yml", "recipe"),
)
LARGEST_WHEEL = 1.4e6
"""Alarm for the size of the wheel [bytes]. The aim is a million; CONTRIBUTING.md, "Release", says why it is more."""
URDFS = ("bleex.urdf", "bleex_identified.urdf", "cuhk.urdf", "dfki_double_pendulum.urdf")

CHECK = """
import exoid, pathlib
from exoid import published
leg = exoid.load_leg("cuhk", side="right")
assert leg.joint_names == ("right_hip", "right_knee")
assert exoid.load_leg("bleex", inertias="identified").parameters.shape == (9,)
data = exoid.datasets.bleex_swing()
assert exoid.identify(data.leg, data.train).names[:3] == ("X1", "Y1", "J1")
assert published.bleex_parameters("left")["J1"] == 2.38
print(pathlib.Path(exoid.__file__).resolve().parent)
"""

pytestmark = pytest.mark.skipif(not (ROOT / "pyproject.toml").is_file(), reason="needs the source tree")


def run(*words, cwd, **environment):
    env = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    return processes.run(*words, cwd=cwd, env={**env, **environment}).strip()


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of what belongs to the project: building leaves no trace in the checkout."""
    copy = tmp_path_factory.mktemp("source") / "exoid"
    copy.mkdir()
    for name in (*SOURCES, *MORE_SOURCES):
        path = ROOT / name
        if path.is_dir():
            shutil.copytree(path, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif path.exists():
            shutil.copy(path, copy / name)
    return copy


@pytest.fixture(scope="module")
def built(source, tmp_path_factory):
    """The source distribution, and the wheel built from it."""
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, source, cwd=folder)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist


def venv(folder):
    """A new environment that finds the dependencies of this one, but neither exoid nor what .pth files say."""
    run(sys.executable, "-m", "venv", "--without-pip", folder, cwd=folder.parent)
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    site = Path(run(python, "-c", "import sysconfig; print(sysconfig.get_paths()['purelib'])", cwd=folder))
    lent = folder / "dependencies"
    lent.mkdir()
    for place in (Path(each) for each in sys.path if each.endswith("site-packages") and "cmeel.prefix" not in each):
        for item in place.iterdir():
            if "exoid" not in item.name and not (lent / item.name).exists():
                (lent / item.name).symlink_to(item)
    cmeel = Path("cmeel.prefix", "lib", f"python{sys.version_info[0]}.{sys.version_info[1]}", "site-packages")
    (site / "dependencies.pth").write_text(f"{lent}\n{lent / cmeel}\n", encoding="utf-8")
    return python


def pip_install(python, *words, cwd):
    """Install with the pip of this environment; nothing is downloaded."""
    offline = ("--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--disable-pip-version-check")
    run(sys.executable, "-m", "pip", "--python", python, "install", *offline, *words, cwd=cwd)


@pytest.mark.slow
def test_the_wheel_works_from_a_foreign_folder(built, tmp_path):
    wheel, _ = built
    python = venv(tmp_path / "venv")
    pip_install(python, wheel, cwd=tmp_path)
    package = Path(run(python, "-c", CHECK, cwd=tmp_path))
    assert tmp_path.resolve() in package.parents
    assert ROOT not in package.parents
    shown = run(python.with_name("exoid"), "identify", "bleex", "bleex_swing:train", "-o", "leg.json", cwd=tmp_path)
    assert "wls estimate of 20 parameters" in shown
    assert "NRMSE" in run(python.with_name("exoid"), "validate", "leg.json", "bleex_swing:test", cwd=tmp_path)


@pytest.mark.slow
def test_the_wheel_contains_urdfs_tables_logs_and_the_typing_marker(built):
    wheel, _ = built
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {f"exoid/urdf/{name}" for name in URDFS} <= names
    assert {"exoid/__init__.pyi", "exoid/py.typed"} <= names
    assert {"exoid/leg/published/bleex.toml", "exoid/leg/published/cuhk.toml"} <= names
    assert "exoid/codegen/leg.c.jinja" in names
    assert {"exoid/signals/datasets/bleex_swing.csv", "exoid/signals/datasets/bleex_swing_test.csv"} <= names
    assert "exoid/view/scenes/page.html" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert {name.split("/")[0] for name in names} == {"exoid", f"exoid-{exoid.__version__}.dist-info"}
    assert not any("__pycache__" in name for name in names)


@pytest.mark.slow
def test_every_module_of_the_source_is_in_the_wheel(source, built):
    wheel, _ = built
    modules = {path.relative_to(source).as_posix() for path in (source / "exoid").rglob("*.py")}
    assert modules <= set(zipfile.ZipFile(wheel).namelist())


@pytest.mark.slow
def test_the_source_distribution_can_be_tested_and_rebuilt(built):
    _, sdist = built
    with tarfile.open(sdist) as archive:
        names = {Path(*Path(name).parts[1:]).as_posix() for name in archive.getnames()}
    assert {"pyproject.toml", "README.md", "LICENSE", "scripts/make_urdfs.py", "docs/legs.md"} <= names
    assert {f"urdf/{name}" for name in URDFS} <= names
    assert "tests/packaging/test_packaging.py" in names


@pytest.mark.slow
def test_the_source_distribution_holds_files_of_the_repository_only(built):
    _, sdist = built
    with tarfile.open(sdist) as archive:
        names = {Path(*Path(member.name).parts[1:]).as_posix() for member in archive if member.isfile()}
    in_git = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=False, cwd=ROOT)
    if in_git.returncode or not in_git.stdout:
        pytest.skip("needs a clone")
    assert names - set(in_git.stdout.splitlines()) == {"PKG-INFO"}


def deflated(text):
    """Size in a wheel [bytes]."""
    return len(zlib.compress(text, 9))


def without_docstrings(source):
    """Source of a module with empty lines in place of docstrings."""
    lines = source.decode().splitlines()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            lines[node.body[0].lineno - 1 : node.body[0].end_lineno] = [""] * (
                node.body[0].end_lineno - node.body[0].lineno + 1
            )
    return "\n".join(lines).encode()


@pytest.mark.slow
def test_the_wheel_is_small(built):
    """It prints what the size consists of; CONTRIBUTING.md states these figures."""
    wheel, _ = built
    with zipfile.ZipFile(wheel) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    modules = [content for name, content in files.items() if name.endswith(".py")]
    logs = [content for name, content in files.items() if name.endswith(".csv")]
    sizes = {"wheel": wheel.stat().st_size, "modules": sum(map(deflated, modules)), "logs": sum(map(deflated, logs))}
    sizes["headers"] = sizes["wheel"] - sum(map(deflated, files.values()))
    sizes["modules without docstrings"] = sum(deflated(without_docstrings(each)) for each in modules)
    print(f"\n{len(files)} files; " + ", ".join(f"{what} {size / 1e6:.2f} MB" for what, size in sizes.items()))
    assert sizes["wheel"] <= LARGEST_WHEEL
    assert sizes["modules without docstrings"] < sizes["modules"] < sizes["wheel"]
