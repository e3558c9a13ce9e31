"""Every verb works on a leg of one joint."""

import shutil

import pytest
from one_joint import swing, write_urdf

import exoid
from exoid.cli.verbs import VERBS

COMMANDS = {
    "identify": "identify one.urdf log.csv --test test.csv -o new.json --report report.html",
    "identify --own": "identify one.urdf log.csv test.csv --own offset --terms coulomb,offset,viscous -o own.json",
    "check": "check one.urdf log.csv",
    "select": "select one.urdf log.csv --folds 3",
    "validate": "validate est.json test.csv",
    "interaction": "interaction est.json test.csv -o torque.csv --report report.html",
    "compare": "compare est.json other.json",
    "export": "export est.json -o leg.urdf",
    "export --c": "export est.json --c leg.c",
    "export --mjcf": "export est.json --mjcf leg.xml",
    "plan": "plan one.urdf --duration 10 --starts 1 -o plan.csv --figures drawn",
    "plan --assess": "plan one.urdf --assess log.csv --figures drawn",
    "view": "view one.urdf --html leg.html",
    "view --log": "view est.json --log log.csv --html leg.html",
    "track": "track est.json --period 1",
    "track --reference": "track est.json --reference short.csv",
}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("one")
    leg = write_urdf(folder / "one.urdf")
    for seed, (log, estimate) in enumerate((("log", "est"), ("test", "other"))):
        swing(leg, seconds=8.0, seed=seed).to_csv(folder / f"{log}.csv")
        exoid.identify(leg, exoid.Recording.from_csv(folder / f"{log}.csv")).save(folder / f"{estimate}.json")
    swing(leg, seconds=2.0).to_csv(folder / "short.csv")
    return folder


def test_every_verb_is_here():
    legs = {"coordinate", "reproduce", "wear"}  # of a machine or a wearer that has hip and knee
    assert {command.split()[0] for command in COMMANDS} == set(VERBS) - legs


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_verb_works_on_one_joint(inputs, tmp_path, exoid_, name):
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)
    run = exoid_(*COMMANDS[name].split())
    assert run.printed.strip()
    assert "Error" not in run.err
