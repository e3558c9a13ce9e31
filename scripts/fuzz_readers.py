"""Fuzz the readers of logs and URDFs with atheris: a find is anything but a result or an ExoidError.

Run ``pip install atheris``, then, each for ten minutes,

    python scripts/fuzz_readers.py csv -max_total_time=600
    python scripts/fuzz_readers.py urdf -max_total_time=600

Arguments after the kind are libFuzzer's. An input that breaks a reader is written to ``crash-…`` in this folder; keep
it as a test.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["exoid"]):
    import exoid
    from exoid.leg.description import describe

SEEDS = {
    "csv": (
        b"time,q_hip,tau_hip\n" + b"".join(b"%d.0,0.%d,1\n" % (k, k) for k in range(12)),
        b'# a\n"t";"q_hip"\r\n' + b"".join(b"%d;1,5\r\n" % k for k in range(12)),
        b"\xef\xbb\xbftime\tq_a\tv_a\n" + b"".join(b"0.%02d\t0.1\t0\n" % k for k in range(12)),
    ),
    "urdf": tuple(path.read_bytes() for path in (Path(exoid.__file__).parents[1] / "urdf").glob("*.urdf")),
}
"""What to start from."""


def read_csv(data: bytes) -> None:
    """Read bytes as a log."""
    LOG.write_bytes(data)
    exoid.Recording.from_file(LOG)


def read_urdf(data: bytes) -> None:
    """Read bytes as a URDF, and ask for a regressor."""
    leg = exoid.Leg.from_description(describe(data.decode("utf-8", "surrogateescape")))
    zero = [[0.0] * len(leg.joint_names)]
    leg.regressor(zero, zero, zero)


def one_input(data: bytes) -> None:
    """Give one input to the reader; only the one error is allowed."""
    try:
        READ(data)
    except exoid.ExoidError as error:
        if "\n" in str(error) or not error.what.strip():
            raise AssertionError("not one line") from error


if __name__ == "__main__":
    kind = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    READ = {"csv": read_csv, "urdf": read_urdf}.get(kind) or sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        LOG, corpus = Path(folder) / "log.csv", Path(folder) / "corpus"
        corpus.mkdir()
        for number, seed in enumerate(SEEDS[kind]):
            (corpus / str(number)).write_bytes(seed)
        atheris.Setup([*sys.argv, str(corpus)], one_input)
        atheris.Fuzz()
