"""Every exported function and method says what it takes and what it returns."""

import importlib
import inspect
import pkgutil

import pytest

import exoid

PACKAGES = ["exoid", *(f"exoid.{m.name}" for m in pkgutil.iter_modules(exoid.__path__) if not m.name.startswith("_"))]


def exported(package):
    """Functions and methods that a package exports and exoid defines, by their full name."""
    module = importlib.import_module(package)
    for name in getattr(module, "__all__", ()):
        thing = getattr(module, name)
        if not getattr(thing, "__module__", "").startswith("exoid."):
            continue
        if inspect.isfunction(thing):
            yield f"{package}.{name}", thing
        elif inspect.isclass(thing):
            for method, value in vars(thing).items():
                function = getattr(value, "__func__", value)
                inherited = any(method in vars(base) for base in thing.__mro__[1:])  # what it takes is said there
                if inspect.isfunction(function) and not method.startswith("_") and not inherited:
                    yield f"{package}.{name}.{method}", function


def lacks(function):
    """Sections that the docstring of a function should have and does not."""
    doc, signature = inspect.getdoc(function) or "", inspect.signature(function)
    takes = [name for name in signature.parameters if name not in ("self", "cls")]
    gives = signature.return_annotation not in (None, "None", inspect.Signature.empty, "NoReturn")
    sections = (("Args:", bool(takes)), ("Returns:", gives and "Yields:" not in doc))
    return [section for section, wanted in sections if wanted and section not in doc]


@pytest.mark.parametrize("package", PACKAGES)
def test_exported_functions_say_what_they_take_and_return(package):
    found = {name: lacks(function) for name, function in exported(package)}
    poor = {name: missing for name, missing in found.items() if missing}
    assert not poor, "\n".join(f"{name} lacks {', '.join(missing)}" for name, missing in sorted(poor.items()))
