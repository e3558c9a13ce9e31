"""No command is shown that nothing runs: ``exoid`` by the test of its page, any other by a place that a table names."""

import re
import shlex

import pytest
from doc_pages import FENCE, ROOT, SHELL, exoid_commands, shell_commands

from exoid.cli.verbs import load_verb

PAGES = [
    path.relative_to(ROOT).as_posix() for path in (*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md")))
]

LANGUAGES = {"python", *SHELL, "text", "toml", "c", "mermaid", ""}
"""Shell is nothing but bash and console, so that no block can be left out by its name. Blocks of none are printed."""

IN_CI = ".ci/run"

RUN_BY = {
    "pip install .": IN_CI,
    "pip install '.[view]'": IN_CI,
    "pip install '.[test]'": IN_CI,
    "pytest": IN_CI,
    "ruff check .": IN_CI,
    "ruff format --check .": IN_CI,
    "mypy": IN_CI,
    "lint-imports": IN_CI,
    "pytest tests/benchmarks -s": IN_CI,
    "cc -std=c99 -Wall -Wextra -Wpedantic -O2 main.c leg.c -lm -o leg": "tests/codegen/test_microcontroller_page.py",
    "cc -std=c99 -Wall -Wextra -Wpedantic -O2 main.c law.c -lm -o law": "tests/codegen/test_microcontroller_page.py",
    "./leg": "tests/codegen/test_microcontroller_page.py",
    "./law": "tests/codegen/test_microcontroller_page.py",
    "python scripts/study_teststand.py": "tests/signals/datasets/test_study_of_teststand.py",
    "python scripts/make_urdfs.py": "tests/leg/test_urdfs.py",
    "python scripts/make_bleex_swing.py": "tests/signals/datasets/test_bleex_swing.py",
}
"""Commands other than ``exoid``, each with the file in the repository that runs it."""

COMPARE = "OMP_NUM_THREADS=1 peers/bin/python -W ignore scripts/peers/compare.py --peers"

NOT_RUN = {
    "python3 -m venv .venv": "a folder of its own; .ci/run makes one elsewhere",
    ". .venv/bin/activate": "as above",
    "pip install -e '.[test,lint]'": "changes the installation that the tests run in; .ci/run installs without -e",
    ".ci/run": "it runs these tests",
    "pip install figaroh": "optional, from the network: the comparison is skipped without it",
    "python -m venv peers": "an environment of its own, for tools that exoid does not need",
    "peers/bin/pip install . -r scripts/peers/requirements.txt": "other tools from the network, some hundred megabytes",
    f"{COMPARE} figaroh mujoco_regressor": "needs these tools; tests/packaging/test_peers.py runs what does not",
    f"{COMPARE} mujoco --seeds 5": "as above",
    "gz sdf -p leg.urdf > leg.sdf": "needs Gazebo, which is no Python package",
}
"""Commands that nothing runs, each with the reason."""

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


def uncovered(shown):
    """Commands that nothing runs and for which no reason is given."""
    return [each for each in shown if not each.startswith("exoid ") and each not in {**RUN_BY, **NOT_RUN}]


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_a_page_is_run_or_says_why_not(page):
    assert not uncovered(commands(page))
    if page not in ("README.md", "CHANGELOG.md") and not page.startswith("docs/"):
        assert not [each for each in commands(page) if each.startswith("exoid ")], "no test runs this page"


def test_a_command_that_nothing_runs_is_found():
    assert uncovered(shell_commands("$ exoid view bleex && make all  # builds\npytest\n")) == ["make all"]


def test_the_tables_name_no_command_that_no_page_shows():
    shown = {command for page in PAGES for command in commands(page)}
    assert not {*RUN_BY, *NOT_RUN} - shown


@pytest.mark.parametrize(("command", "place"), [item for item in RUN_BY.items() if item[1] != IN_CI])
def test_the_place_that_runs_a_command_has_its_words(command, place):
    words = {"cc": '"cc "', "./": "build", "py": command.removeprefix("python scripts/").removesuffix(".py")}
    assert words[command[:2]] in (ROOT / place).read_text(encoding="utf-8")


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
            assert f'"{option}"' in source or option == "--help", f"{name} {option}"


def test_a_command_with_a_wrong_option_does_not_parse():
    with pytest.raises(Exception, match="No such option"):
        load_verb("view").make_context("exoid view", ["bleex", "--colour", "red"])
