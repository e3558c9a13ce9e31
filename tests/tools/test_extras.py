"""Commands that install what a feature needs work however exoid was installed."""

import shlex
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from exoid.tools import extras
from exoid.tools.extras import install_extra

tomllib = pytest.importorskip("tomllib")
PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
EXTRAS = ("io", "view", "ground", "robots", "scale")


@pytest.mark.skipif(not PROJECT.is_file(), reason="needs the source tree")
@pytest.mark.parametrize("extra", EXTRAS)
def test_a_command_names_the_packages_of_an_extra(extra):
    wanted = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["optional-dependencies"][extra]
    assert sorted(shlex.split(install_extra(extra))) == sorted(["pip", "install", *wanted])


def test_in_a_source_tree_the_extra_is_named(monkeypatch):
    def requires(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(extras, "requires", requires)
    assert install_extra("ground") == "pip install 'exoid[ground]'"
