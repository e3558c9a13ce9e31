"""What is public exists, is documented and annotated, and its examples are true."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
from types import ModuleType

import pytest

import exoid

MODULES = sorted(["exoid", *(m.name for m in pkgutil.walk_packages(exoid.__path__, "exoid."))])
PACKAGES = [name for name in MODULES if hasattr(importlib.import_module(name), "__path__")]


def public_names(module):
    return getattr(module, "__all__", [name for name in vars(module) if not name.startswith("_")])


def public_objects():
    """Functions and classes defined in exoid and not marked private, with their methods, by dotted name."""
    found = {}
    for name in MODULES:
        module = importlib.import_module(name)
        for attribute, item in vars(module).items():
            if attribute.startswith("_") or getattr(item, "__module__", None) != name:
                continue
            if inspect.isclass(item) or inspect.isfunction(item):
                found[f"{name}.{attribute}"] = item
            if inspect.isclass(item):
                found |= {f"{name}.{attribute}.{method}": item.__dict__[method] for method in own_methods(item)}
    return found


def own_methods(kind):
    """Public methods and properties written in a class, not those that a decorator or a base class made."""
    return [
        name
        for name, member in vars(kind).items()
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, (property, classmethod)))
    ]


def function_of(member):
    if isinstance(member, property):
        return member.fget
    return member.__func__ if isinstance(member, classmethod) else member


OBJECTS = public_objects()


@pytest.mark.parametrize("name", PACKAGES)
def test_the_table_of_contents_is_sorted_and_every_name_in_it_exists(name):
    module = importlib.import_module(name)
    names = module.__all__
    assert module.__doc__
    assert len(set(names)) == len(names)
    assert list(names) == sorted(names, key=lambda n: (n.islower(), not n.isupper(), n)), "as ruff sorts it"
    for item in names:
        assert hasattr(module, item), item


def test_the_names_promised_to_users_are_there():
    assert {"load_leg", "Leg", "Recording", "identify", "Estimate", "validate", "datasets", "ExoidError"} <= set(
        exoid.__all__
    )


def test_star_import_gives_the_table_of_contents():
    namespace: dict[str, object] = {}
    exec("from exoid import *", namespace)
    assert set(exoid.__all__) <= set(namespace)


@pytest.mark.parametrize("name", OBJECTS)
def test_everything_public_has_a_docstring(name):
    assert (inspect.getdoc(OBJECTS[name]) or "").strip()


@pytest.mark.parametrize("name", [name for name, item in OBJECTS.items() if not inspect.isclass(item)])
def test_every_public_function_is_annotated(name):
    signature = inspect.signature(function_of(OBJECTS[name]))
    assert signature.return_annotation is not inspect.Signature.empty
    for parameter in signature.parameters.values():
        assert parameter.name in ("self", "cls") or parameter.annotation is not inspect.Parameter.empty, parameter


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings_are_true(name):
    module = importlib.import_module(name)
    assert isinstance(module, ModuleType)
    globals_ = {**{each: getattr(exoid, each) for each in exoid.__all__}, **vars(module), "exoid": exoid}
    failed, _ = doctest.testmod(module, extraglobs=globals_, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


def test_there_are_examples_to_run():
    finder = doctest.DocTestFinder()
    count = sum(len(test.examples) for name in MODULES for test in finder.find(importlib.import_module(name)))
    assert count >= 10
