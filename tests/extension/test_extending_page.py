"""docs/extending.md shows the code of the package, and its script runs as it stands."""

import re
from pathlib import Path

import pytest
from springs import PROJECT, command, run

PAGE = Path(__file__).resolve().parents[2] / "docs" / "extending.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S) if PAGE.is_file() else []

pytestmark = pytest.mark.skipif(not BLOCKS, reason="needs the source tree")


def blocks(language):
    return [block for written, block in BLOCKS if written == language]


def files():
    return [path.read_text(encoding="utf-8") for path in (PROJECT / "exoid_springs").glob("*.py")]


def test_the_code_is_that_of_the_package():
    shown = [block for block in blocks("python") if "register_term(" not in block]
    assert len(shown) == 3
    for block in shown:
        assert any(block in text for text in files()), block


@pytest.mark.slow
def test_the_script_of_the_page_runs_and_a_command_names_what_it_does_not_know(tmp_path, recording):
    recording.to_csv(tmp_path / "log.csv")
    (script,) = [block for block in blocks("python") if "register_term(" in block]
    assert "mad estimate of 12 parameters" in run("-c", script, path=[PROJECT], cwd=tmp_path)
    refused = command("validate", "est.json", "log.csv", path=[PROJECT], cwd=tmp_path, code=2)
    (shown,) = blocks("text")
    assert refused.startswith(shown.strip().removesuffix("."))
