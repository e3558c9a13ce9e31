"""CSV logs of any delimiter and unit; that they come back bit by bit is in test_log_files."""

import math

import numpy as np
import pytest

from exoid.signals import Recording, Recordings

HEADER = "time,q_hip,q_knee,tau_hip,tau_knee"
ROWS = [f"{0.02 * k:.2f},{0.1 * math.sin(k / 9):.4f},{-0.01 * k:.2f},{k},{-k}.5" for k in range(12)]


@pytest.fixture
def log(tmp_path):
    """Write lines (or bytes) as log.csv and return its path."""

    def write(content):
        path = tmp_path / "log.csv"
        path.write_bytes(content if isinstance(content, bytes) else "\n".join(content).encode())
        return path

    return write


def test_joints_come_from_the_angle_columns_in_the_order_of_the_file(log):
    recording = Recording.from_csv(log([HEADER, *ROWS]))
    assert recording.joint_names == ("hip", "knee")
    np.testing.assert_array_equal(recording.q[:, 1], [-0.01 * round(k) if k else 0.0 for k in range(12)])
    np.testing.assert_array_equal(recording.tau[3], [3.0, -3.5])
    assert recording.v is None
    assert recording.a is None


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"], ids=["plain", "BOM"])
def test_delimiters_line_endings_and_byte_order_marks_do_not_matter(log, delimiter, ending, mark):
    lines = ["# made by a logger", HEADER.replace(",", " , "), *ROWS[:5], "", "# pause", *ROWS[5:], "", ",,,,", "  "]
    text = ending.join(line.replace(",", delimiter) for line in lines)
    recording = Recording.from_csv(log(mark + text.encode()))
    plain = Recording.from_csv(log([HEADER, *ROWS]))
    assert recording.joint_names == plain.joint_names
    for name in ("time", "q", "tau"):
        np.testing.assert_array_equal(getattr(recording, name), getattr(plain, name))


@pytest.mark.parametrize("read", [Recording.from_csv, Recording.from_file, Recordings.from_folder])
def test_a_misspelt_option_is_refused_as_python_refuses_arguments(read, tmp_path):
    (tmp_path / "log.csv").write_text("time,q_hip\n")
    with pytest.raises(TypeError, match="angel_unit"):
        read(tmp_path if read == Recordings.from_folder else tmp_path / "log.csv", angel_unit="deg")
