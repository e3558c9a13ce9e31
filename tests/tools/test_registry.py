"""Classes by name, and their settings in files: what was written comes back exactly; the rest is refused before."""

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outcomes import refused

from exoid.errors import BadArgumentError, ExoidError
from exoid.tools.registry import Registry


@dataclass(frozen=True)
class Inner:
    """A setting that has parts."""

    number: float = 1.0


@dataclass(frozen=True)
class Thing:
    """Anything with a setting."""

    setting: Any = 0
    derived: float = field(init=False, default=2.0)


@dataclass(frozen=True)
class Demanding:
    """It has no default."""

    setting: float


def registry():
    made = Registry("thing", "exoid.register_thing")
    made.register("thing", Thing)
    made.register("demanding", Demanding)
    return made


PLAIN = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False, allow_infinity=False), st.text())
SETTINGS = st.recursive(PLAIN, lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=8)


@given(setting=SETTINGS)
def test_settings_come_back_exactly(setting):
    text = json.dumps(registry().to_json(Thing(setting)), allow_nan=False, ensure_ascii=False)
    again = registry().from_json(json.loads(text.encode()))
    assert repr(again.setting) == repr(setting)  # types and the sign of zero, too


NO_JSON = np.zeros(3), np.float32(0.1), np.int64(1), np.nan, np.inf, 1j, [1.0], {"a": 1.0}, {1, 2}, (1, [2]), b"a"
REFUSED = {
    "a setting that JSON cannot hold": [lambda x=x: registry().to_json(Thing(x)) for x in (*NO_JSON, "\udc80", print)],
    "a class without a name": [lambda: registry().to_json(Inner())],
    "a class without defaults": [lambda: registry().default("demanding")],
    "a name that is taken": [lambda: registry().register("thing", Demanding)],
    "no name": [lambda x=x: registry().register(x, Thing) for x in ("", "a b", "a,b", "-a", "a/b", None, 3, print)],
}


@pytest.mark.parametrize("call", [call for calls in REFUSED.values() for call in calls])
def test_it_is_refused_with_advice(call):
    assert refused(BadArgumentError, call).remedy


def test_a_class_is_found_by_its_name_and_registered_once_more():
    things = registry()
    things.register("thing", Thing)
    assert things.find("thing") is Thing
    assert things.default("thing") == Thing()


@pytest.mark.parametrize("name", ["other", "", None, ["thing"]])
def test_an_unknown_name_says_what_there_is_and_how_to_make_it_known(name):
    with pytest.raises(ExoidError) as caught:
        registry().find(name)
    assert caught.value.what == f"no thing {name!r}"
    assert "use some of demanding, thing" in caught.value.remedy
    assert f"exoid.register_thing({name!r}, ...)" in caught.value.remedy
