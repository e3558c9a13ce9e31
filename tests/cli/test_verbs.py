"""The command line imports a verb when it is called, and lists all verbs without."""

import inspect
import shlex
import subprocess
import sys

import pytest

from exoid.cli.verbs import VERBS, load_verb

HEAVY = ("numpy", "pinocchio", "scipy", "matplotlib", "jinja2", "meshcat", "lxml", "pooch")


def imported_by(*arguments):
    """Exit status of ``exoid ARGUMENTS`` in a fresh interpreter, and modules that it imported."""
    program = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))\n"
    done = subprocess.run(
        [sys.executable, "-c", f"{program}from exoid.cli import main; main()", *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        timeout=120,
    )
    return done.returncode, set(done.stderr.splitlines()[-1].split())


@pytest.mark.parametrize(("arguments", "code"), [(["--help"], 0), (["--version"], 0), (["identfy"], 2)])
def test_no_verb_is_imported_before_one_is_called(arguments, code):
    status, modules = imported_by(*arguments)
    assert status == code
    assert not modules & set(HEAVY)
    assert {name for name in modules if name.startswith("exoid")} == {
        *("exoid", "exoid._version", "exoid.errors", "exoid.tools", "exoid.tools.tables"),
        *("exoid.cli", "exoid.cli.app", "exoid.cli.messages", "exoid.cli.verbs"),
    }


def test_the_help_of_a_verb_needs_no_numbers_and_no_legs():
    """Its import had grown to five times that of NumPy."""
    status, modules = imported_by("identify", "--help")
    assert status == 0
    assert not modules & {*HEAVY, "rich.progress", "exoid.leg"}


@pytest.mark.parametrize("name", VERBS)
def test_the_line_in_the_list_of_verbs_is_the_first_of_the_verbs_own_help(name):
    verb = load_verb(name)
    assert verb.name == name
    first, *_ = inspect.cleandoc(verb.help).split("\n\n")
    assert " ".join(first.split()) == VERBS[name]


def example_of(name):
    """Arguments of the example in a verb's help."""
    (line,) = [line for line in inspect.cleandoc(load_verb(name).help).splitlines() if line.startswith("Example: ")]
    exoid, *arguments = shlex.split(line.removeprefix("Example: "))
    assert exoid == "exoid"
    return arguments


@pytest.mark.parametrize("name", VERBS)
def test_the_example_of_a_verbs_help_has_arguments_that_the_verb_knows(name):
    verb, *arguments = example_of(name)
    assert verb == name
    load_verb(name).make_context(name, arguments)


@pytest.mark.nightly
def test_the_examples_of_the_help_run(exoid_):
    """But those that other tests run, for a minute each."""
    assert exoid_("identify", "bleex", "bleex_swing:train", "--estimator", "huber", "-o", "other.json").code == 0
    for name in VERBS:
        if name not in ("coordinate", "reproduce", "wear", "track"):
            assert exoid_(*example_of(name)).printed
