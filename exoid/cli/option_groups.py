"""Options declared once as a named tuple: a verb takes the tuple, and its command line has the fields."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from functools import wraps
from inspect import Parameter, get_annotations, signature
from types import MappingProxyType
from typing import Annotated, Any, get_args, get_type_hints

import typer
from typer.models import OptionInfo

Verb = Callable[..., None]

ON_REQUEST = {"LogOptions": "log", "LimitOptions": "limits"}
"""Groups whose options --help leaves out: --help-log shows those of LogOptions."""

METAVARS: dict[Any, str] = {str: "NAME", str | None: "NAME", int: "N", int | None: "N", float: "X", float | None: "X"}
"""What help writes for a value of a type, where the option does not say it."""


def expand_options(without: Mapping[str, Sequence[str]] = MappingProxyType({})) -> Callable[[Verb], Verb]:
    """Replace each parameter of a verb that is a named tuple by the fields of the tuple."""

    def decorate(verb: Verb) -> Verb:
        hints = get_annotations(verb, eval_str=True)  # get_type_hints of 3.10 changes a default None
        parameters = list(signature(verb).parameters.values())
        kinds = {each.name: hints[each.name] for each in parameters}
        groups = {name: kind for name, kind in kinds.items() if isinstance(kind, type) and hasattr(kind, "_fields")}
        fields = {
            name: [field for field in group._fields if field not in without.get(name, ())]
            for name, group in groups.items()
        }

        @wraps(verb)
        def run(**given: Any) -> None:  # noqa: ANN401 - whatever the options are
            for name, group in groups.items():
                given.pop(f"help_{ON_REQUEST.get(group.__name__)}", None)  # was answered before
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
                else [_declared(each.replace(annotation=hints[each.name]))]
            )
        ]
        for name, group in groups.items():
            if word := ON_REQUEST.get(group.__name__):
                about = str(group.__doc__).removesuffix(".").lower()
                more = f"Show the {len(fields[name])} options of {about}."
                asked = typer.Option(f"--help-{word}", is_eager=True, callback=_show_group, help=more)
                kind = Parameter.POSITIONAL_OR_KEYWORD
                expanded.append(Parameter(f"help_{word}", kind, default=False, annotation=Annotated[bool, asked]))
        run.__signature__ = signature(verb).replace(parameters=expanded)  # type: ignore[attr-defined]
        run.__annotations__ = {each.name: each.annotation for each in expanded} | {"return": None}
        return run

    return decorate


def _fields(group: Any, names: Sequence[str]) -> Iterator[Parameter]:  # noqa: ANN401 - class of a named tuple
    """Parameters of a verb for the fields of a group."""
    hints = get_type_hints(group, include_extras=True)
    for name in names:
        default = group._field_defaults.get(name, Parameter.empty)
        field = Parameter(name, Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=hints[name])
        yield _declared(field, ON_REQUEST.get(group.__name__))


def _declared(parameter: Parameter, group: str | None = None) -> Parameter:
    """Give an option the usual name of its value, and hide it if its group is shown on request."""
    kind, *declared = get_args(parameter.annotation) or (None,)
    if not declared or not isinstance(declared[0], OptionInfo):
        return parameter
    option = copy(declared[0])
    option.metavar = option.metavar or METAVARS.get(kind)
    completing = "_EXOID_COMPLETE" in os.environ  # a shell completes options that help leaves out, too
    group = group or str(option.rich_help_panel or "") or None  # one option may say itself that it is on request
    option.hidden, option.rich_help_panel = group is not None and not completing, group
    return parameter.replace(annotation=Annotated[kind, option])


def _show_group(context: typer.Context, asked: typer.CallbackParam, wanted: bool) -> None:
    """Show the options of one group in place of the usual ones, and stop."""
    if not wanted or context.resilient_parsing:
        return
    each: Any
    for each in context.command.params:
        each.hidden = getattr(each, "rich_help_panel", None) != str(asked.name).removeprefix("help_")
    typer.echo(context.get_help())
    raise typer.Exit
