"""What is public exists, and its examples are true; ruff asks for docstrings and mypy for annotations."""

import doctest
import importlib
import pkgutil

import pytest

import exoid

MODULES = sorted(["exoid", *(m.name for m in pkgutil.walk_packages(exoid.__path__, "exoid."))])
PACKAGES = [name for name in MODULES if hasattr(importlib.import_module(name), "__path__")]


def test_tables_of_contents_are_sorted_and_every_name_in_them_exists():
    for name in PACKAGES:
        module = importlib.import_module(name)
        names = getattr(module, "__all__", ())  # exoid.tools is for exoid itself
        assert module.__doc__, name
        assert len(set(names)) == len(names), name
        assert list(names) == sorted(names, key=lambda n: (n.islower(), not n.isupper(), n)), name  # as ruff sorts it
        assert [item for item in names if not hasattr(module, item)] == [], name


@pytest.mark.slow
def test_examples_in_docstrings_are_true(forgetful):
    names, tried = {each: getattr(exoid, each) for each in exoid.__all__}, 0
    for name in MODULES:
        module = importlib.import_module(name)
        globals_ = {**names, **vars(module), "exoid": exoid}
        failed, examples = doctest.testmod(module, extraglobs=globals_, optionflags=doctest.NORMALIZE_WHITESPACE)
        assert failed == 0, name
        tried += examples
    assert tried >= 10
