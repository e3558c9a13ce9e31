"""Options that several verbs have are declared once, as a named tuple."""

import inspect
from typing import Annotated, NamedTuple, get_origin

import pytest
import typer
from typer.testing import CliRunner

from exoid.cli.option_groups import expand_options
from exoid.cli.options import LogOptions, given
from exoid.cli.verbs import VERBS, load_verb


class Reading(NamedTuple):
    """A group of two options."""

    start: Annotated[float | None, typer.Option(metavar="S", help="First time.")] = None
    degrees: Annotated[bool, typer.Option("--degrees", help="Angles in degrees.")] = False


class Rival(NamedTuple):
    """A group with an option of the same name."""

    start: Annotated[int, typer.Option()] = 1


READING, RIVAL = Reading(), Rival()


def command(seen, **without):
    """Command whose verb keeps the group that it receives."""
    app = typer.Typer()

    @app.command()
    @expand_options(without)
    def verb(name: str, reading: Reading = READING, last: bool = False) -> None:
        """Do nothing."""
        seen.append((name, reading, last))

    return app, verb


def test_a_verb_receives_the_group_and_its_command_line_has_the_fields():
    seen = []
    app, verb = command(seen)
    assert list(inspect.signature(verb).parameters) == ["name", "start", "degrees", "last"]
    done = CliRunner().invoke(app, ["leg", "--start", "2.5", "--degrees", "--last"])
    assert done.exit_code == 0, done.output
    assert CliRunner().invoke(app, ["leg"]).exit_code == 0
    assert seen == [("leg", Reading(2.5, True), True), ("leg", Reading(), False)]


def test_a_field_that_a_verb_does_not_have_keeps_its_default():
    seen = []
    app, _ = command(seen, reading=("degrees",))
    assert CliRunner().invoke(app, ["leg", "--degrees"]).exit_code == 2
    assert CliRunner().invoke(app, ["leg", "--start", "1"]).exit_code == 0
    assert seen == [("leg", Reading(1.0), False)]


def test_two_options_of_one_name_are_an_error_of_the_program():
    with pytest.raises(ValueError, match="duplicate parameter name: 'start'"):

        @expand_options()
        def verb(reading: Reading = READING, rival: Rival = RIVAL) -> None:
            """Do nothing."""


def test_options_that_were_given_are_named_as_on_the_command_line():
    found = given(LogOptions(base_position="0,0,0", degrees=True))
    assert {name for name, value in found.items() if value is not None} == {"--base-position", "--degrees"}
    assert set(found) == {f"--{name.rstrip('_').replace('_', '-')}" for name in LogOptions._fields}


@pytest.mark.parametrize("name", ["identify", "check", "validate", "interaction", "select", "plan", "view", "track"])
def test_every_verb_that_reads_logs_has_the_same_options_for_them(name):
    options = {option for each in load_verb(name).params for option in each.opts}
    own = {"--payload", "--base-position", "--wrench"} if name == "track" else set()  # there, the payload of the rig
    assert set(given(LogOptions())) - own <= options
    assert name in VERBS


def test_an_option_without_default_value_keeps_its_short_name():
    """Python 3.10 makes Optional[Annotated[...]] of such a hint, and the option would lose its names."""

    @expand_options()
    def verb(output: Annotated[str | None, typer.Option("--output", "-o")] = None) -> None:
        """Do nothing."""

    assert get_origin(inspect.signature(verb).parameters["output"].annotation) is Annotated


def test_an_option_of_several_verbs_takes_the_same_kind_of_value_in_each():
    """Only what --output writes differs: each verb has a file of its own."""
    kinds = {}
    for name in VERBS:
        for each in load_verb(name).params:
            if each.param_type_name == "option" and each.metavar is not None:
                kinds.setdefault(each.opts[0], {}).setdefault(each.metavar, []).append(name)
    assert {option: found for option, found in kinds.items() if len(found) > 1 and option != "--output"} == {}
