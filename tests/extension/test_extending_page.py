"""docs/extending.md shows the code of the package, and its commands and its script run as they stand."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from springs import PROJECT, command, run, write_metadata

PAGE = Path(__file__).resolve().parents[2] / "docs" / "extending.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S) if PAGE.is_file() else []

pytestmark = pytest.mark.skipif(not BLOCKS, reason="needs the source tree")


def blocks(language):
    return [block for written, block in BLOCKS if written == language]


def files():
    return [path.read_text(encoding="utf-8") for path in (PROJECT / "exoid_springs").glob("*.py")]


def test_the_code_is_that_of_the_package():
    shown = [block for block in blocks("python") if "register_term(" not in block]
    assert len(shown) == 4
    for block in shown:
        assert any(block in text for text in files()), block
    (metadata,) = blocks("toml")
    assert metadata in (PROJECT / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_commands_run_where_the_package_is_installed_and_the_script_where_it_is_not(tmp_path, recording):
    write_metadata(tmp_path / "site")
    recording.to_csv(tmp_path / "log.csv")
    (commands,) = blocks("bash")
    for line in commands.splitlines():
        command(*shlex.split(line)[1:], path=(tmp_path / "site", PROJECT), cwd=tmp_path)
    assert (tmp_path / "leg.c").is_file()
    assert (tmp_path / "leg.exoid.json").is_file()
    shutil.rmtree(tmp_path / "site")
    (script,) = [block for block in blocks("python") if "register_term(" in block]
    assert "mad estimate of 12 parameters" in run("-c", script, path=[PROJECT], cwd=tmp_path).stdout
    refused = command("validate", "est.json", "log.csv", path=[PROJECT], cwd=tmp_path, code=2).stderr
    (shown,) = blocks("text")
    assert refused.startswith(shown.strip().removesuffix("."))
