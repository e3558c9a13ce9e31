"""Templates of C: filled in one precision, with texts made harmless and arrays of constants."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .dialect import Dialect, comment

if TYPE_CHECKING:
    from jinja2 import Environment


def fill(template: str, dialect: Dialect, **values: object) -> str:
    """Fill a template of this package, in which numbers and functions have one precision."""
    environment = _environment(dialect)
    found = environment.from_string(template) if "\n" in template else environment.get_template(template)
    return found.render(values)


def step_of(name: str) -> str:
    """Read the statements of a law, a template to be filled with its names."""
    return resources.files(__package__).joinpath("steps", f"{name}.c.jinja").read_text(encoding="utf-8")


def sized(name: str, **values: int | str) -> str:
    """Read the statements of a law, with sizes and texts that stand in them."""
    return "".join(f"{{% set {key} = {value!r} %}}\n" for key, value in values.items()) + step_of(name)


@cache
def _environment(dialect: Dialect) -> Environment:
    """Settings of all templates; names of files count from this package, and each file is compiled once."""
    import jinja2  # noqa: PLC0415 - an estimate needs it only to be written as C

    folder = resources.files(__package__)
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text(encoding="utf-8")),
        autoescape=False,  # it is no HTML: texts pass the filter "comment"
        undefined=jinja2.StrictUndefined,  # a misspelt name is an error, not an empty text
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["comment"] = comment
    environment.globals.update(precision=dialect.real, number=dialect.number, function=dialect.function)
    environment.globals["initial"] = lambda array: initializer(array.values, dialect)
    environment.globals["dimensions"] = lambda array: "".join(f"[{size}]" for size in array.values.shape)
    return environment


def initializer(values: NDArray[Any], dialect: Dialect, indent: str = "") -> str:
    """Write the initializer of an array."""
    if values.ndim == 0:
        return str(int(values)) if np.issubdtype(values.dtype, np.integer) else dialect.number(float(values))
    if values.ndim == 1:
        return "{" + ", ".join(initializer(value, dialect) for value in values) + "}"
    inner = f"{indent}    "
    rows = ",\n".join(f"{inner}{initializer(row, dialect, inner)}" for row in values)
    return f"{{\n{rows}\n{indent}}}"
