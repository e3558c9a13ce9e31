"""exoid runs on Linux and macOS: what only one system has is called in one place, behind a look at the system."""

import ast
import re
from pathlib import Path

import pytest
from processes import run_python

PACKAGE = Path(__file__).resolve().parents[2] / "exoid"
MODULES = {"fcntl", "grp", "pty", "pwd", "resource", "termios", "winreg", "msvcrt"}
"""Modules of the standard library that some systems lack."""
CALLS = {"fork", "getrusage", "killpg", "memfd_create", "pipe2", "prctl", "sched_getaffinity", "sendfile", "setsid"}
"""Functions that some systems lack, or whose unit differs, as that of ru_maxrss."""
KINDS = {"float128", "longdouble", "complex256"}
"""Numbers that have 80 bits on x86-64, 64 on a Mac with ARM."""
ALLOWED = {("tools/reader_process.py", "resource"), ("tools/reader_process.py", "/proc")}

pytestmark = pytest.mark.skipif(not PACKAGE.is_dir(), reason="needs the source tree")


def found_in(source):
    """Names of modules, functions and kinds of numbers that are not the same everywhere."""
    if not any(word in source for word in (*MODULES, *CALLS, *KINDS, "/proc")):
        return  # parsing takes longer than looking
    for node in ast.walk(ast.parse(source)):
        names = []
        if isinstance(node, ast.Import):
            names = [each.name.split(".")[0] for each in node.names if each.name.split(".")[0] in MODULES]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [node.module.split(".")[0]] if node.module.split(".")[0] in MODULES else []
        elif isinstance(node, ast.Attribute):
            names = [node.attr] if node.attr in CALLS | KINDS else []
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.startswith("/proc"):
            names = ["/proc"]
        yield from names


def test_what_one_system_has_is_used_in_one_place():
    uses = {
        (path.relative_to(PACKAGE).as_posix(), name)
        for path in PACKAGE.rglob("*.py")
        for name in found_in(path.read_text(encoding="utf-8"))
    }
    assert uses == ALLOWED


@pytest.mark.slow
def test_logs_are_read_and_legs_identified_as_on_macos(tmp_path):
    """In a process that takes this system for macOS; a child without bounds reads the file of MATLAB."""
    code = (
        "import sys, numpy, scipy.io, scipy.signal, pinocchio, rich, lxml.etree, joblib\n"
        "sys.platform = 'darwin'\n"
        "import exoid\n"
        "data = exoid.datasets.bleex_swing()\n"
        "content = {'time': data.train.time}\n"
        "for j, name in enumerate(data.leg.joint_names):\n"
        "    content.update({f'q_{name}': data.train.q[:, j], f'tau_{name}': data.train.tau[:, j]})\n"
        "scipy.io.savemat('log.mat', content)\n"
        "log = exoid.Recording.from_file('log.mat', data.leg.joint_names)\n"
        "est = exoid.identify(data.leg, log)\n"
        "est.save('leg.json'); est.to_urdf('leg.urdf')\n"
        "assert exoid.validate(exoid.Estimate.load('leg.json'), data.test).verdict == 'predicts'\n"
        "print(len(est.names))\n"
    )
    assert run_python(code, cwd=tmp_path).split() == ["20"]


def test_typing_of_the_oldest_python_has_what_is_imported_from_it():
    newer = "Unpack|Self|Required|NotRequired|Never|LiteralString|override|assert_never|assert_type"
    pattern = re.compile(rf"^from typing import (\([^)]*|.*)\b({newer})\b", re.MULTILINE)
    assert not [path.name for path in PACKAGE.rglob("*.py") if pattern.search(path.read_text(encoding="utf-8"))]
