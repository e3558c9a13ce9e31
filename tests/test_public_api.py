"""What is public exists, is documented and annotated, and its examples are true."""

import doctest
import importlib
import inspect
import pkgutil

import pytest

import exoid

MODULES = sorted(["exoid", *(m.name for m in pkgutil.walk_packages(exoid.__path__, "exoid."))])
PACKAGES = [name for name in MODULES if hasattr(importlib.import_module(name), "__path__")]


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


def test_tables_of_contents_are_sorted_and_every_name_in_them_exists():
    for name in PACKAGES:
        module = importlib.import_module(name)
        names = getattr(module, "__all__", ())  # exoid.tools is for exoid itself
        assert module.__doc__, name
        assert len(set(names)) == len(names), name
        assert list(names) == sorted(names, key=lambda n: (n.islower(), not n.isupper(), n)), name  # as ruff sorts it
        assert [item for item in names if not hasattr(module, item)] == [], name


def test_everything_public_has_a_docstring():
    assert len(OBJECTS) > 1000
    assert [name for name, item in OBJECTS.items() if not (inspect.getdoc(item) or "").strip()] == []


def test_every_public_function_is_annotated():
    functions = {name: function_of(item) for name, item in OBJECTS.items() if not inspect.isclass(item)}
    assert [name for name, function in functions.items() if not annotated(function)] == []


def annotated(function):
    signature = inspect.signature(function)
    parameters = [each for each in signature.parameters.values() if each.name not in ("self", "cls")]
    annotations = [signature.return_annotation, *(each.annotation for each in parameters)]
    return inspect.Signature.empty not in annotations


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
