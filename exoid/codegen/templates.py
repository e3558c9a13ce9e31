"""Templates of C: filled in one precision, with texts made harmless."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from .dialect import Dialect, comment

if TYPE_CHECKING:
    from jinja2 import Environment


def fill(template: str, dialect: Dialect, **values: object) -> str:
    """Fill a template of this package, in which numbers and functions have one precision."""
    environment = _environment(dialect)
    found = environment.from_string(template) if "\n" in template else environment.get_template(template)
    return found.render(values)


@cache
def _environment(dialect: Dialect) -> Environment:
    """Settings of all templates; names of files count from this package, and each file is compiled once."""
    import jinja2  # noqa: PLC0415 - an estimate needs it only to be written as C

    folder = resources.files(__package__)
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text(encoding="utf-8")),
        autoescape=False,  # it is no HTML: texts pass the filter "comment"
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["comment"] = comment
    environment.globals.update(precision=dialect.real, number=dialect.number, function=dialect.function)
    return environment
