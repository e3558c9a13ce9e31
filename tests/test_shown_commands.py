"""Commands that pages show parse, and the scripts that they name have the options."""

import re
import shlex

import pytest
from doc_pages import FENCE, ROOT, SHELL, exoid_commands, shell_commands

from exoid.cli.verbs import load_verb

PAGES = [
    path.relative_to(ROOT).as_posix() for path in (*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md")))
]

LANGUAGES = {"python", *SHELL, "text", "toml", "xml", "c", "mermaid", ""}
"""Shell is nothing but bash and console, so that no block can be left out by its name. Blocks of none are printed."""


pytestmark = pytest.mark.skipif(not (ROOT / "docs").is_dir(), reason="needs the source tree")


def blocks(page):
    return FENCE.findall((ROOT / page).read_text(encoding="utf-8"))


def commands(page):
    return [command for language, text in blocks(page) if language in SHELL for command in shell_commands(text)]


def studies(page):
    """Indented commands: studies of minutes to hours, whose figures the page prints beside them. They are not run."""
    text = (ROOT / page).read_text(encoding="utf-8").replace("\\\n", " ")
    lines = re.findall(r"^    (?:\$ )?((?:exoid|python|pytest) .+)$", text, re.M)
    return [command for line in lines for command in shell_commands(line)]


@pytest.mark.parametrize("page", PAGES)
def test_no_block_is_left_out_by_its_language_or_its_indent(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    assert {language for language, _ in blocks(page)} <= LANGUAGES
    assert not [
        block for language, block in blocks(page) if not language and re.search(r"^(\$|exoid|pip) ", block, re.M)
    ]
    assert len(re.findall(r"^\s*(?:```|~~~)", text, re.MULTILINE)) == 2 * len(blocks(page))


@pytest.mark.parametrize("page", PAGES)
def test_every_shown_command_parses(page):
    """In a moment, without a run: verbs, options and their values are those of the command."""
    for line in exoid_commands("\n".join([*commands(page), *studies(page)])):
        verb, *arguments = shlex.split(line)[1:]
        if arguments != ["--help"]:
            load_verb(verb).make_context(f"exoid {verb}", arguments)


@pytest.mark.parametrize("page", PAGES)
def test_every_script_that_a_page_names_exists_and_has_the_options(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for name, options in re.findall(r"python (scripts/\w+\.py)((?: +[^\s`|,;:)#&]+)*)", text):
        source = (ROOT / name).read_text(encoding="utf-8")
        shared = [ROOT / "scripts" / f"{module}.py" for module in re.findall(r"^from (\w+) import", source, re.M)]
        source += "".join(path.read_text(encoding="utf-8") for path in shared if path.is_file())
        for option in re.findall(r" (--[a-z][\w-]*)", options):
            number = "run_seeds(" in source and f"{option[2:]}=" in source  # an option of a study by its name
            assert f'"{option}"' in source or number or option == "--help", f"{name} {option}"
