"""What a release states in several files agrees: version, date, dependencies, versions of Python, names."""

import json
import re
import runpy
import sys
from pathlib import Path

import pytest

import exoid

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
RECIPE = ROOT / "recipe" / "recipe.yaml"
CONDA = {"pin": "pinocchio", "matplotlib": "matplotlib-base", "meshcat": "meshcat-python", "mujoco": "mujoco-python"}
"""Names on conda-forge that differ from those on PyPI."""

pytestmark = pytest.mark.skipif(not RECIPE.is_file(), reason="needs the source tree")


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def on_conda(requirements):
    """Requirements with the names of conda-forge; markers count for all versions, as the recipe is noarch."""
    parted = [re.match(r"([\w-]+)(.*?)(?:;|$)", each).groups() for each in requirements]
    return {(CONDA.get(name, name), bound.strip()) for name, bound in parted}


def listed(recipe, key):
    """Names and bounds below a key of the recipe."""
    block = re.search(rf"^  {key}:\n((?:    - .*\n)+)", recipe, re.MULTILINE)[1]
    lines = [line.strip()[2:].split("#")[0] for line in block.splitlines()]
    return {tuple((line.strip() + " ").split(" ", 1)) for line in lines}


def stripped(pairs):
    return {(name, bound.strip()) for name, bound in pairs}


def test_the_recipe_has_the_dependencies_of_the_project(project):
    recipe = RECIPE.read_text(encoding="utf-8")
    run = stripped(listed(recipe, "run"))
    assert run - {("python", ">=${{ python_min }}")} == on_conda(project["dependencies"])
    assert f'python_min: "{project["requires-python"][2:]}"' in recipe


def test_the_recipe_bounds_what_the_extras_need(project):
    extras = project["optional-dependencies"]
    wanted = on_conda([each for name in ("io", "ground", "stance", "view", "robots", "scale") for each in extras[name]])
    wanted = {(name, bound) for name, bound in wanted if name != "example-robot-data-loaders"}
    assert stripped(listed(RECIPE.read_text(encoding="utf-8"), "run_constraints")) == wanted


def test_every_file_states_the_same_version():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    assert f"\nversion: {exoid.__version__}\n" in citation
    assert zenodo["version"] == exoid.__version__
    assert f'version: "{exoid.__version__}"' in RECIPE.read_text(encoding="utf-8")


def test_the_newest_section_of_the_changelog_is_the_version_and_its_date():
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    sections = re.findall(r"^## \[(.*?)\](.*)$", changelog, re.MULTILINE)
    assert sections[0] == ("Unreleased", "")
    version, date = sections[1]
    assert version == exoid.__version__
    assert f"\ndate-released: {date.removeprefix(' - ')}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_zenodo_and_the_citation_say_the_same():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    assert f'title: "{zenodo["title"]}"' in citation
    assert f'abstract: "{zenodo["description"]}"' in citation
    assert f"date-released: {zenodo['publication_date']}" in citation
    assert f"license: {zenodo['license']}" in citation
    assert all(f"  - {word}\n" in citation for word in zenodo["keywords"])


def test_the_classifiers_name_the_versions_of_python_that_are_tested(project):
    named = [each.rpartition(" ")[2] for each in project["classifiers"] if re.search(r":: 3\.\d+$", each)]
    assert named == ["3.10", "3.11", "3.12", "3.13"]
    assert project["requires-python"] == f">={named[0]}"


def test_the_index_page_turns_relative_links_into_text():
    pytest.importorskip("hatchling")
    readme = (
        "# exoid\n\n![a leg](docs/images/leg.png)\n\nYou need Python, pip and a copy of this repository, "
        "[logs](docs/logs.md#units),\n[docs/limits.md](docs/limits.md), [pin](https://example.org/a(b))\n"
    )
    shown = runpy.run_path(str(ROOT / "hatch_build.py"))["index_page"](readme, "9.9")
    assert "exoid==9.9" in shown
    assert "leg.png" not in shown
    assert "logs (`docs/logs.md`),\n`docs/limits.md`, [pin](https://example.org/a(b))" in shown
    assert "Python and pip" in shown
