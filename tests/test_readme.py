"""The README's Python and its commands run as they stand, in a folder that has what its reader is assumed to have."""

import numpy as np
import pytest
from doc_pages import FENCE, ROOT, SHELL, Page, exoid_commands, own_leg, real_data, run

import exoid

README = ROOT / "README.md"
PAGE = Page.read("README.md")
BLOCKS = FENCE.findall(README.read_text(encoding="utf-8")) if README.is_file() else []
SHOWN = [text for language, text in BLOCKS if language in SHELL]
COMMANDS = [
    pytest.param(
        block,
        id=commands[0][6:],
        marks=[*real_data(block), *([pytest.mark.nightly] if "exoid reproduce bleex" in commands else [])],
    )
    for block in SHOWN
    if (commands := exoid_commands(block))
]

pytestmark = pytest.mark.skipif(not BLOCKS, reason="needs the source tree")


@pytest.fixture
def folder(tmp_path):
    """A folder with ``my_leg.urdf`` and ``log.csv``, whose columns have other names."""
    own_leg(tmp_path)
    train = exoid.datasets.bleex_swing().train.select(("left_hip", "left_knee"))
    table = np.column_stack([train.time, np.rad2deg(train.q), train.tau])
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="t,pos1,pos2,torque1,torque2", comments="")
    return tmp_path


@pytest.mark.slow
def test_the_python_runs_from_top_to_bottom(folder):
    out = run(folder, PAGE.python, name=PAGE.name)
    assert "wls estimate of 20 parameters" in out
    assert "too few" in out


def test_the_readme_is_short():
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 200


@pytest.mark.slow
@pytest.mark.parametrize("block", COMMANDS)
def test_the_commands_run(block, folder, monkeypatch, capsys):
    printed = Page(PAGE.name, "", exoid_commands(block), ()).run_here(folder, monkeypatch, capsys)
    for output in PAGE.shown:
        if output.splitlines()[0] in printed:
            assert output in printed, "the README shows what the command printed before"


def test_all_output_that_is_shown_is_tested():
    assert len(PAGE.shown) == 1
    assert len(COMMANDS) == 6


def test_every_parameter_is_in_the_table(estimate):
    text = README.read_text(encoding="utf-8")
    for symbol in {name.split("_")[0] for name in estimate.names if "_" in name}:
        assert f"`{symbol}_<joint>`" in text


def test_the_parameter_that_is_shown_is_the_one_that_is_identified(estimate):
    found = estimate["X1"]
    assert f"`X1  {found.value:.4f} ± {found.std:.4f} kg·m`" in README.read_text(encoding="utf-8")
