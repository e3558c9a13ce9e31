"""The command line, run in this process."""

from __future__ import annotations

import sys
from typing import NamedTuple

import pytest

from exoid.cli import main


class Run(NamedTuple):
    """Exit status, standard output and standard error."""

    code: int
    out: str
    err: str


@pytest.fixture
def exoid_(capsys, monkeypatch, tmp_path):
    """Run ``exoid ARGUMENTS`` in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["exoid", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return Run(int(stop.value.code or 0), *capsys.readouterr())

    return run
