"""Names that other packages add to: taken ones are refused, unknown ones are named."""

import pytest

from exoid.errors import ExoidError
from exoid.tools.registry import Registry


def refuse_empty(thing):
    if not thing:
        raise ExoidError("an empty thing", remedy="fill it")


def registry():
    made = Registry("thing", "exoid.register_thing", refuse_empty)
    made.register("built-in", "ours")
    return made


def test_a_registered_thing_is_found_and_listed():
    things = registry()
    assert things.register("theirs", "a") == "a"
    assert things.find("theirs") == things["theirs"] == "a"
    assert list(things) == ["built-in", "theirs"]
    assert len(things) == 2
    assert things.name_of("a") == "theirs"
    assert things.name_of("b") is None
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


@pytest.mark.parametrize("name", ["", "a b", "a,b", "-a", "a/b", None, 3, refuse_empty])
def test_what_cannot_be_a_name_is_refused(name):
    with pytest.raises(ExoidError, match=r"is no name for a thing.*exoid\.register_thing\(\"name\""):
        registry().register(name, "a")


@pytest.mark.parametrize("name", ["other", "", None, ["built-in"]])
def test_an_unknown_name_says_what_there_is_and_how_to_make_it_known(name):
    with pytest.raises(ExoidError) as caught:
        registry().find(name)
    assert caught.value.what == f"no thing {name!r}"
    assert "use some of built-in" in caught.value.remedy
    assert f"exoid.register_thing({name!r}, ...)" in caught.value.remedy
