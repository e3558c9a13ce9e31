"""The glossary is alphabetical, and the names of the API in it exist."""

import importlib
import inspect
import re
from pathlib import Path

import pytest

import exoid

PAGE = Path(__file__).resolve().parents[1] / "docs" / "glossary.md"
ROWS = [
    [cell.strip() for cell in line.strip().strip("|").split("|")]
    for line in (PAGE.read_text(encoding="utf-8").splitlines() if PAGE.is_file() else [])
    if line.startswith("|") and not line.startswith(("|---", "| term |"))
]
NAME = re.compile(r"[A-Za-z_.]+(\([\w\s,.=\"{}:]*\))?")
"""A dotted name, perhaps with arguments; commands, columns and names of parameters have digits, spaces or signs."""

STANDS_FOR = {"est": "Estimate", "leg": "Leg"}
CODE = [(row[0], code) for row in ROWS for code in re.findall(r"`([^`]+)`", row[-1]) if NAME.fullmatch(code)]

pytestmark = pytest.mark.skipif(not ROWS, reason="needs the source tree")


def find(dotted):
    """Object of a dotted name within exoid; None for one that is set only on instances, such as a field."""
    first, *rest = dotted.removeprefix("exoid.").split(".")
    found = exoid
    for part in (STANDS_FOR.get(first, first), *rest):
        if inspect.ismodule(found) and not hasattr(found, part):
            found = importlib.import_module(f"{found.__name__}.{part}")
        elif part in getattr(found, "__dataclass_fields__", {}) or part in getattr(found, "_fields", ()):
            found = None
        else:
            found = getattr(found, part)
    return found


def test_names_of_the_api_exist():
    for term, code in CODE:
        name, _, arguments = code.partition("(")
        found = find(name)
        for keyword in re.findall(r"(\w+)=", arguments):
            assert keyword in inspect.signature(found).parameters, term
