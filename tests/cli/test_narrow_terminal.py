"""On a terminal of 60 columns no verb prints a longer line, and no table loses a letter or a number."""

import shlex

import pytest

import exoid
from exoid.cli.verbs import VERBS
from exoid.tools.tables import NARROWEST, WIDTH, line_width

COMMANDS = {
    "identify": "identify bleex train.csv wrong.csv --test test.csv",
    "identify-own": "identify bleex train.csv test.csv --own offset",
    "check": "check bleex wrong.csv --stop 10",
    "select": "select bleex train.csv --folds 3 --stop 8",
    "validate": "validate est.json train.csv test.csv wrong.csv",
    "interaction": "interaction est.json test.csv",
    "compare": "compare est.json other.json",
    "export": "export est.json -o leg.urdf",
    "plan": "plan cuhk -o plan.csv --duration 3 --starts 1",
    "plan-assess": "plan bleex --assess test.csv",
    "track": "track est.json --period 1",
    "track-dry": "track est.json --dry-run test.csv",
    "wear": "wear est.json --period 2",
    "reproduce": "reproduce cuhk",
    "coordinate": "coordinate bleex",
}
QUICK = {"check", "compare", "export", "validate"}
MARKS = {name: pytest.mark.slow for name in COMMANDS if name not in QUICK}
MARKS |= dict.fromkeys(("select", "wear", "reproduce", "coordinate"), pytest.mark.nightly)


@pytest.fixture(scope="module")
def estimates(data):
    return [exoid.identify(data.leg, log, check=False) for log in (data.train, data.test)]


@pytest.fixture
def folder(tmp_path, data, estimates):
    """Two logs, one with torques of the wrong sign, and two estimates."""
    data.train.to_csv(tmp_path / "train.csv")
    data.test.to_csv(tmp_path / "test.csv")
    log = data.train
    exoid.Recording(log.time, log.q, tau=-log.tau, joint_names=log.joint_names).to_csv(tmp_path / "wrong.csv")
    for estimate, name in zip(estimates, ("est.json", "other.json"), strict=True):
        estimate.save(tmp_path / name)


@pytest.fixture
def printed(exoid_, folder, monkeypatch):
    """What a command prints where ``$COLUMNS`` is a width, or is not set."""
    before = line_width.get()

    def at(width, command):
        line_width.set(before)
        if width is not None:
            monkeypatch.setenv("COLUMNS", str(width))
        run = exoid_(*shlex.split(command))
        assert run.code in (0, 1), run.err
        return run.out

    yield at
    line_width.set(before)


def test_every_verb_with_a_table_is_tried():
    assert {command.split()[0] for command in COMMANDS.values()} == set(VERBS) - {"view"}, "view writes one line"


@pytest.mark.parametrize("name", [pytest.param(name, marks=MARKS.get(name, ())) for name in COMMANDS])
def test_no_line_is_longer_than_60_characters_and_no_word_is_lost(printed, name):
    narrow, wide = printed(NARROWEST, COMMANDS[name]), printed(WIDTH, COMMANDS[name])
    assert max(map(len, narrow.splitlines())) <= NARROWEST
    assert set(wide.replace("─", "").split()) == set(narrow.replace("─", "").split())


def test_a_pipe_receives_the_widest_lines_unless_columns_says_otherwise(printed):
    piped = printed(None, COMMANDS["compare"])
    assert NARROWEST < max(map(len, piped.splitlines())) <= WIDTH
    assert printed(WIDTH, COMMANDS["compare"]) == printed(1000, COMMANDS["compare"]) == piped
