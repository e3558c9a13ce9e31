"""Options declared once as a named tuple: a verb takes the tuple, and its command line has the fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import wraps
from inspect import Parameter, get_annotations, signature
from types import MappingProxyType
from typing import Any, get_type_hints

Verb = Callable[..., None]

NOTHING: Mapping[str, Sequence[str]] = MappingProxyType({})
"""No field."""


def expand_options(without: Mapping[str, Sequence[str]] = NOTHING) -> Callable[[Verb], Verb]:
    """Replace each parameter of a verb that is a named tuple by the fields of the tuple."""

    def decorate(verb: Verb) -> Verb:
        hints = get_annotations(verb, eval_str=True)  # get_type_hints of 3.10 changes a default None
        parameters = list(signature(verb).parameters.values())
        groups = {each.name: hints[each.name] for each in parameters if _is_group(hints[each.name])}
        fields = {
            name: [field for field in group._fields if field not in without.get(name, ())]
            for name, group in groups.items()
        }

        @wraps(verb)
        def run(**given: Any) -> None:  # noqa: ANN401 - whatever the options are
            for name, group in groups.items():
                given[name] = group(**{field: given.pop(field) for field in fields[name]})
                if getattr(given[name], "columns", None) is not None:
                    from .column_map import with_map  # noqa: PLC0415 - help needs no files

                    given[name] = with_map(given[name], given[name].columns)
            verb(**given)

        expanded = [
            one
            for each in parameters
            for one in (
                _fields(groups[each.name], fields[each.name])
                if each.name in groups
                else [each.replace(annotation=hints[each.name])]
            )
        ]
        run.__signature__ = signature(verb).replace(parameters=expanded)  # type: ignore[attr-defined]
        run.__annotations__ = {each.name: each.annotation for each in expanded} | {"return": None}
        return run

    return decorate


def _is_group(kind: Any) -> bool:  # noqa: ANN401 - any annotation
    return isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields")


def _fields(group: Any, names: Sequence[str]) -> Iterator[Parameter]:  # noqa: ANN401 - class of a named tuple
    """Parameters of a verb for the fields of a group."""
    hints = get_type_hints(group, include_extras=True)
    for name in names:
        default = group._field_defaults.get(name, Parameter.empty)
        yield Parameter(name, Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=hints[name])
