"""Names that other packages add to: taken ones are refused, installed ones are found, broken ones are named."""

from __future__ import annotations

import importlib
import sys

import pytest

from exoid.errors import ExoidError
from exoid.tools.registry import Registry


def refuse_empty(thing):
    if not thing:
        raise ExoidError("an empty thing", remedy="fill it")


def registry():
    made = Registry("thing", "exoid.tests", "exoid.register_thing", refuse_empty)
    made.register("built-in", "ours")
    return made


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install a distribution of one module, whose entry points are these."""
    modules = set(sys.modules)
    monkeypatch.syspath_prepend(tmp_path)

    def write(name, module, text, **offers):
        info = tmp_path / f"{name}-2.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 2.0\n", encoding="utf-8")
        lines = [f"{key.replace('_', '-')} = {value}" for key, value in offers.items()]
        (info / "entry_points.txt").write_text("\n".join(["[exoid.tests]", *lines]), encoding="utf-8")
        (tmp_path / f"{module}.py").write_text(text, encoding="utf-8")

    yield write
    for name in set(sys.modules) - modules:
        del sys.modules[name]


def test_a_registered_thing_is_found_and_listed():
    things = registry()
    assert things.register("theirs", "a") == "a"
    assert things.find("theirs") == things["theirs"] == "a"
    assert list(things) == ["built-in", "theirs"]
    assert len(things) == 2
    assert things.registered == ("built-in", "theirs")
    assert "theirs" in things
    assert "other" not in things
    assert things.get("other") is None
    assert repr(things) == "<things: built-in, theirs>"


def test_a_name_that_is_taken_is_refused_and_both_are_named():
    things = registry()
    with pytest.raises(ExoidError, match=r"the thing 'built-in' exists: 'ours'.*give 'theirs' another name"):
        things.register("built-in", "theirs")
    assert things.find("built-in") == "ours"
    things.register("built-in", "ours")  # the same once more


def test_a_class_that_is_defined_anew_replaces_the_old_one():
    """As in a cell of a notebook that runs again; a function of another place does not."""
    things = registry()
    cell = "class Mine:\n    pass\ndef other():\n    pass"
    first, second = {"__name__": "cell"}, {"__name__": "cell"}
    exec(cell, first)
    exec(cell, second)
    things.register("mine", first["Mine"])
    things.register("mine", second["Mine"])
    assert things.find("mine") is second["Mine"]
    with pytest.raises(ExoidError, match=r"exists: cell\.Mine.*give cell\.other another name"):
        things.register("mine", second["other"])


@pytest.mark.parametrize("name", ["", "a b", "a,b", "-a", "a/b", None, 3, refuse_empty])
def test_what_cannot_be_a_name_is_refused(name):
    with pytest.raises(ExoidError, match=r"is no name for a thing.*exoid\.register_thing\(\"name\""):
        registry().register(name, "a")


def test_a_thing_that_fails_the_check_is_refused_and_not_registered():
    things = registry()
    with pytest.raises(ExoidError, match="an empty thing"):
        things.register("empty", "")
    assert "empty" not in things


@pytest.mark.parametrize("name", ["other", "", None, ["built-in"]])
def test_an_unknown_name_says_what_there_is_and_how_to_make_it_known(name):
    with pytest.raises(ExoidError) as caught:
        registry().find(name)
    assert caught.value.what == f"no thing {name!r}"
    assert "use some of built-in" in caught.value.remedy
    assert "install the package that provides it" in caught.value.remedy
    assert f"exoid.register_thing({name!r}, ...)" in caught.value.remedy


def test_an_installed_thing_is_found_by_its_name_and_imported_only_then(install):
    install("theirs", "theirs_module", "THING = object()", far="theirs_module:THING")
    things = registry()
    assert list(things) == ["built-in", "far"]
    assert "far" in things
    assert len(things) == 2
    assert things.registered == ("built-in",)
    assert "theirs_module" not in sys.modules
    found = things.find("far")
    assert found is sys.modules["theirs_module"].THING
    assert things.registered == ("built-in", "far")
    assert things["far"] is found


def test_the_name_of_a_thing_whose_package_is_installed_is_found(install):
    text = "class Thing:\n    pass\n\nclass Nameless:\n    pass"
    install("theirs", "theirs_module", text, far="theirs_module:Thing")
    install("strange", "strange_module", "raise RuntimeError", strange="strange_module:Thing")
    theirs_module = importlib.import_module("theirs_module")
    things = registry()
    assert things.name_of("ours") == "built-in"
    assert things.name_of(theirs_module.Thing) == "far"
    assert things.name_of(theirs_module.Nameless) is None  # and a broken package that is not asked does not matter
    assert things.name_of(object()) is None


def test_what_is_registered_comes_before_what_is_installed(install):
    install("theirs", "theirs_module", "raise RuntimeError", built_in="theirs_module:THING", far="theirs_module:THING")
    things = registry()
    things.register("far", "nearer")
    assert things.find("built-in") == "ours"
    assert things.find("far") == "nearer"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("raise RuntimeError('no licence')", "RuntimeError: no licence"),
        ("import module_that_is_missing", "ModuleNotFoundError: No module named 'module_that_is_missing'"),
        ("THING =", "SyntaxError"),
        ("", "AttributeError"),
        ("raise SystemExit(3)", "SystemExit: 3"),
        ("THING = ''", "an empty thing"),
    ],
)
def test_a_broken_entry_point_names_its_distribution(install, text, why):
    install("theirs", "theirs_module", text, far="theirs_module:THING")
    with pytest.raises(ExoidError) as caught:
        registry().find("far")
    assert caught.value.what.startswith(f"the thing 'far' of theirs 2.0 (theirs_module:THING) cannot be loaded: {why}")
    assert caught.value.remedy == "mend or uninstall theirs"
    assert "\n" not in str(caught.value)


def test_two_distributions_that_offer_one_name_are_refused(install):
    install("theirs", "theirs_module", "THING = 1", far="theirs_module:THING")
    install("others", "others_module", "THING = 2", far="others_module:THING")
    with pytest.raises(ExoidError, match=r"'far' is offered by \w+ 2\.0 and by \w+ 2\.0.*uninstall all but one"):
        registry().find("far")


def test_an_installed_name_that_no_command_line_could_say_is_refused(install, tmp_path):
    install("theirs", "theirs_module", "THING = 1", **{"far away": "theirs_module:THING"})
    with pytest.raises(ExoidError, match=r"theirs 2\.0 .*'far away' is no name"):
        registry().find("far away")
