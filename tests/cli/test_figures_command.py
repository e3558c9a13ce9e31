"""``--figures`` of identify, validate, interaction and compare: figures of a paper as PDF and SVG."""

import dataclasses
import re

import numpy as np
import pytest

import exoid

ONE, TWO = 3.5 * 72.0, 7.2 * 72.0
"""Widths of one column and of two [points]."""

OF_A_FIT = {
    "parameters": TWO,
    "correlation": ONE,
    "torque": TWO,
    "friction": TWO,
    "residuals_velocity": TWO,
    "residuals_angle": TWO,
}

VERBS = {
    "identify": ("identify bleex log.csv --test worn.csv", OF_A_FIT),
    "validate": ("validate est.json log.csv --cutoff 6", OF_A_FIT),
    "interaction": ("interaction est.json worn.csv --strides 2,4,6,8", {"wearer_torque": TWO, "wearer_gait": ONE}),
    "compare": ("compare est.json other.json", {"comparison": TWO}),
}
"""A command of each verb, and its figures with their widths."""


@pytest.fixture(scope="module")
def inputs(tmp_path_factory, data):
    """A log, one with a wearer, and two estimates."""
    path = tmp_path_factory.mktemp("figures")
    part = data.train.slice(0, 1500)
    part.to_csv(path / "log.csv")
    push = 3.0 * np.sin(np.pi * data.test.time)[:, None]
    dataclasses.replace(data.test, tau=data.test.tau - push).to_csv(path / "worn.csv")
    exoid.identify(data.leg, part).save(path / "est.json")
    exoid.identify(data.leg, data.test).save(path / "other.json")
    return path


@pytest.fixture
def run(inputs, monkeypatch, exoid_):
    """Run the words of a command beside the inputs."""
    monkeypatch.chdir(inputs)
    return lambda words, *more: exoid_(*words.split(), *more)


def width_of_pdf(content):
    """Width of the page of a PDF [points]; its fonts are TrueType, as publishers ask for."""
    assert content.startswith(b"%PDF-")
    assert content.rstrip().endswith(b"%%EOF")
    assert b"/FontFile2" in content
    assert b"/Type3" not in content
    (box,) = re.findall(rb"/MediaBox \[([^]]*)\]", content)
    return float(box.split()[2])


@pytest.mark.slow
@pytest.mark.parametrize("verb", [v if v != "validate" else pytest.param(v, marks=pytest.mark.nightly) for v in VERBS])
def test_each_verb_writes_its_figures_in_the_width_of_a_column_or_two(verb, run, tmp_path):
    words, widths = VERBS[verb]
    code, _, err = run(words, "--figures", tmp_path / "new" / "figures")
    assert code in (0, 1), err
    files = {path.name: path.read_bytes() for path in (tmp_path / "new" / "figures").iterdir()}
    assert sorted(files) == sorted(f"{name}.{form}" for name in widths for form in ("pdf", "svg"))
    assert err.count("wrote") == len(files)
    for name, width in widths.items():
        assert width_of_pdf(files[f"{name}.pdf"]) == pytest.approx(width, abs=0.1), name
        svg = files[f"{name}.svg"].decode()
        assert float(re.search(r'<svg [^>]*width="([0-9.]+)pt"', svg)[1]) == pytest.approx(width, abs=0.1), name
        labels = [text for text in re.findall(r"<!-- (.*?) -->", svg) if text.endswith("]")]
        assert len(labels) >= (2 if name not in ("parameters", "correlation", "comparison") else 1), name
