"""Wrong uses of the command line: each is one line with the cause, the place, and a remedy that works."""

import shutil
from typing import NamedTuple

import numpy as np
import one_joint
import pytest
from small_urdfs import URDF
from swings import harmonics, log_of

import exoid

OFFICE = b"PK\x03\x04\x14\x00\x06\x00[Content_Types].xml" + bytes(range(256)) * 10


class Wrong(NamedTuple):
    """A wrong command, what its line must say, and the same command after the remedy, where it can be run."""

    command: str
    cause: str
    place: str
    remedy: str
    mended: str = ""


RIGHT, CHECKED = "identify leg.urdf log.csv", "validate est.json log.csv"
BY_KIND = {
    "another machine": [
        Wrong("compare est.json one.json", "two machines", "hip, knee and hip", "estimates of one machine"),
        Wrong("validate est.json one.csv", "knee not in the recording", "one.csv", "--column q_knee=HEADER"),
        Wrong("identify leg.urdf log.csv --side left", "has no effect", "leg.urdf", "leave out --side", RIGHT),
    ],
    "swapped or repeated arguments": [
        Wrong("identify log.csv leg.urdf", "no URDF", "log.csv", "URDF here, then the logs", RIGHT),
        Wrong("identify leg.urdf leg.urdf", "XML, such as a URDF", "leg.urdf", "table here, after LEG", RIGHT),
        Wrong("identify est.json log.csv", "JSON, such as an estimate", "est.json", "the leg's URDF", RIGHT),
        Wrong("view log.csv --html v.html", "no URDF", "log.csv", "the leg's URDF", "view leg.urdf --html v.html"),
        Wrong("validate leg.urdf log.csv", "no estimate", "leg.urdf", "identify -o wrote", CHECKED),
        Wrong("validate est.json est.json", "JSON", "est.json", "name a table here", CHECKED),
        Wrong("export leg.urdf -o new.urdf", "no estimate", "leg.urdf", "identify -o", "export est.json -o new.urdf"),
        Wrong("compare est.json nix.json", "no such file", "nix.json", "give the file that exoid identify"),
        Wrong("compare est.json est.json", "is given twice", "est.json", "name two estimates"),
    ],
    "files of another form": [
        Wrong("identify leg.urdf paper.pdf", "is a PDF", "paper.pdf", "as CSV: time, q_<joint>, tau_<joint>"),
        Wrong("identify leg.urdf book.xlsx", "is a spreadsheet", "book.xlsx", "export its table as CSV"),
        Wrong("identify cad.step log.csv", "no URDF", "cad.step", "name the leg's URDF", RIGHT),
        Wrong("identify broken.urdf log.csv", "not well-formed XML", "broken.urdf", "correct the XML"),
        Wrong("validate bad.json log.csv", "no estimate", "bad.json", "identify -o wrote", "validate est.json log.csv"),
        Wrong("identify leg.urdf logs", "no logs in the folder", "logs", ".csv"),
        Wrong("identify leg.urdf lgo.csv", "no such file", "lgo.csv", "did you mean 'log.csv'", RIGHT),
        Wrong("identify lge.urdf log.csv", "no leg or URDF file", "lge.urdf", "did you mean 'leg.urdf'", RIGHT),
        Wrong("identify leg.urdf log.csv --columns leg.urdf", "not TOML", "leg.urdf", "write [columns]"),
    ],
    "columns": [
        Wrong("identify leg.urdf no_torque.csv", "no torque", "no_torque.csv", "--column tau_hip=HEADER"),
        Wrong("identify leg.urdf no_time.csv", "no column 'time'", "no_time.csv", "--column time=HEADER"),
        Wrong("identify leg.urdf other.csv", "no column 'q_<joint>'", "t, pos1, pos2", "--column q_<joint>=HEADER"),
        Wrong(f"{RIGHT} --column q_hipp=q_hip", "misspelt", "q_hipp", "q_hip=q_hip", f"{RIGHT} --column q_hip=q_hip"),
        Wrong(f"{RIGHT} --column q_hip", "--column q_hip", "--column", "NAME=HEADER", f"{RIGHT} --column q_hip=q_hip"),
        Wrong(f"{RIGHT} --mask goood", "no column 'goood'", "log.csv", "a column of 0 and 1"),
        Wrong(f"{RIGHT} --columns typo.toml", "no key 'colums'", "typo.toml", "did you mean 'columns'"),
        Wrong(f"{RIGHT} --unmeasured kne", "is not in the", "log.csv", "hip, knee", f"{RIGHT} --unmeasured knee"),
    ],
    "values": [
        Wrong("identify leg.urdf nan.csv", "nan is not a finite number", "line 51, column tau_knee", "drop those rows"),
        Wrong(
            "identify leg.urdf degrees.csv",
            "looks like degrees, or a slide in mm",
            "column q_",
            "give --degrees",
            "identify leg.urdf degrees.csv --degrees",
        ),
        Wrong(f"{RIGHT} --start 50", "its time stamps are 0 s to 9.99 s", "log.csv", "--start", f"{RIGHT} --start 1"),
    ],
    "names": [
        Wrong(f"{RIGHT} --terms coulombb", "no term", "'coulombb'", "mean 'coulomb'", f"{RIGHT} --terms coulomb"),
        Wrong(f"{RIGHT} --known X9=1", "no parameter", "'X9'", "X1, Y1, J1", f"{RIGHT} --known X1=1"),
        Wrong(f"{RIGHT} --delay 0.01", "--delay", "0.01", "--late JOINT=0.01", f"{RIGHT} --delay auto"),
        Wrong("idnetify leg.urdf log.csv", "No such command", "'idnetify'", "'identify'", RIGHT),
    ],
}
"""Wrong uses by their kind."""

ALL = [pytest.param(wrong, id=wrong.command) for kind in BY_KIND.values() for wrong in kind]


def swing(leg):
    """A log of both joints, with friction and noise."""
    time, phase = np.arange(1000) / 100.0, np.array([[0.0, 1.0], [0.5, 2.0]])
    w, size = np.array([[1.7, 4.1], [2.3, 5.2]]), np.array([[0.5, 0.3], [0.4, 0.3]])
    q, v, a = harmonics(time, size, w, phase)
    return log_of(leg, time, (q - [0.0, 1.0], v, a), 0.3 * np.tanh(v / 0.01) + 0.2 * v, 0.02)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Right files, and each of the wrong ones."""
    path = tmp_path_factory.mktemp("files")
    (path / "leg.urdf").write_text(URDF, encoding="utf-8")
    leg, one = exoid.Leg.from_urdf(path / "leg.urdf"), one_joint.write_urdf(path / "one.urdf")
    for name, of_leg, log in (("log", leg, swing(leg)), ("one", one, one_joint.swing(one, seconds=5.0))):
        log.to_csv(path / f"{name}.csv")
        estimate = path / ("est.json" if name == "log" else "one.json")
        exoid.identify(of_leg, log, check=False).save(estimate)
    head, *rows = (path / "log.csv").read_text(encoding="utf-8").splitlines()
    names, cells = head.split(","), [row.split(",") for row in rows]
    degrees = [57.3 if name.startswith("q_") else 1.0 for name in names]

    def without(*left_out):
        """Lines of the log without some columns."""
        kept = [k for k, name in enumerate(names) if name not in left_out]
        return [",".join(row[k] for k in kept) for row in (names, *cells)]

    def scaled(factors):
        """Lines of the log in other units."""
        return [head, *(",".join(str(f * float(x)) for f, x in zip(factors, row, strict=True)) for row in cells)]

    spoilt = rows[49].rpartition(",")[0]
    tables = {
        "no_knee.csv": without("q_knee", "tau_knee"),
        "no_torque.csv": without("tau_hip", "tau_knee"),
        "no_time.csv": without("time"),
        "other.csv": ["t,pos1,pos2,cur1,cur2", *rows],
        "nan.csv": [head, *rows[:49], f"{spoilt},nan", *rows[50:]],
        "degrees.csv": scaled(degrees),
        "broken.urdf": [URDF[:300]],
        "cad.step": ["ISO-10303-21;", "HEADER;"],
        "bad.json": ["{}"],
        "typo.toml": ['colums = "x"'],
    }
    for name, lines in tables.items():
        (path / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    (path / "paper.pdf").write_bytes(b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n<<>>\nendobj\n" * 20)
    for name in ("book.xlsx", "table.csv"):
        (path / name).write_bytes(OFFICE)
    (path / "logs").mkdir()
    return path


@pytest.fixture
def run(folder, tmp_path, exoid_):
    """Run a command in a copy of the folder."""
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    return lambda command: exoid_(*command.split())


@pytest.mark.parametrize("wrong", ALL)
def test_a_wrong_use_is_one_line_with_cause_place_and_remedy(run, wrong):
    line = run(wrong.command).refusal
    what, _, remedy = line.partition("To fix it: ")
    assert wrong.cause in what
    assert wrong.place in what
    assert wrong.remedy in line if "No such command" in what else wrong.remedy in remedy
    for python in ("exoid.", "known=", "delay=", "columns=", "dataclasses"):
        assert python not in remedy


MENDED = [pytest.param(wrong.mended, id=wrong.command) for kind in BY_KIND.values() for wrong in kind if wrong.mended]


@pytest.mark.parametrize("command", MENDED)
def test_the_remedy_works(run, command):
    unchecked = " --no-check" if command.startswith("identify") else ""  # checks take longer than the fit
    assert run(command + unchecked).code in (0, 1)  # 1: an estimate that does not predict


def test_a_joint_that_a_log_does_not_have_is_held_and_named(run):
    done = run("identify leg.urdf no_knee.csv")
    assert (done.code, done.err) == (0, "not in the log, and held at zero: knee\n")
    assert "J2" not in done.out


def test_a_joint_that_follows_one_of_the_log_is_not_held(run, tmp_path):
    (tmp_path / "mimic.urdf").write_text('<mimic joint="hip"/></joint>'.join(URDF.rsplit("</joint>", 1)))
    done = run("identify mimic.urdf no_knee.csv")
    assert "knee follows hip" in done.err
    assert "--joints hip" in done.err


def test_estimates_by_two_urdfs_are_compared_with_a_word_on_it(run, tmp_path):
    (tmp_path / "heavy.urdf").write_text(URDF.replace('value="2"', 'value="3"', 1), encoding="utf-8")
    assert run("identify heavy.urdf log.csv -o heavy.json").code == 0
    assert (
        "note: the URDFs leg.urdf and heavy.urdf differ: these may be two machines"
        in run("compare est.json heavy.json").out
    )
