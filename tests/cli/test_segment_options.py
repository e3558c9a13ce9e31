"""``--segments`` and ``--mask``: only parts of a log count."""

import json

import numpy as np
import pytest

import exoid

TERMS = ("--terms", "coulomb,viscous")
SPANS = [(4.0 + k, 4.6 + k) for k in range(10)]


@pytest.fixture(scope="module")
def log():
    return exoid.datasets.bleex_swing().train


@pytest.fixture
def segments(tmp_path, log):
    """Write a log, one with a mask, and its segments."""
    log.to_csv(tmp_path / "walk.csv")
    log.segments(SPANS).to_csv(tmp_path / "masked.csv")
    (tmp_path / "swings.csv").write_text("start,stop\n" + "".join(f"{a},{b}\n" for a, b in SPANS))
    named = "".join(f"walk.csv,{a},{b}\n" for a, b in SPANS) + "masked.csv,2.0,8.0\n"
    (tmp_path / "named.csv").write_text("log, start, stop\n" + named)
    return log.segments(SPANS)


def test_segments_of_a_file_and_a_mask_column_give_what_the_interface_gives(exoid_, segments):
    expected = exoid.identify(exoid.load_leg("bleex"), segments, (exoid.Coulomb(), exoid.Viscous()))
    for options in (("walk.csv", "--segments", "swings.csv"), ("masked.csv", "--mask", "mask")):
        run = exoid_("identify", "bleex", *options, *TERMS, "--json", "-o", "est.json")
        assert run.code == 0, run.err
        found = exoid.Estimate.load("est.json")
        np.testing.assert_allclose(found.values, expected.values, rtol=1e-9)
        assert json.loads(run.out)["inputs"][0]["segments"] == [list(pair) for pair in segments.segment_times]


def test_validation_is_of_the_segments(exoid_, segments):
    assert exoid_("identify", "bleex", "walk.csv", "--segments", "swings.csv", *TERMS, "-o", "est.json").code == 0
    expected = exoid.validate(exoid.Estimate.load("est.json"), segments)
    for options in (("walk.csv", "--segments", "swings.csv"), ("masked.csv", "--mask", "mask")):
        run = exoid_("validate", "est.json", *options, "--json")
        assert run.code == 0, run.err
        assert json.loads(run.out)["samples"] == len(expected.time) == np.count_nonzero(segments.mask)
        np.testing.assert_allclose(json.loads(run.out)["rmse"], expected.rmse, rtol=1e-9)


def test_one_file_has_the_segments_of_several_logs_and_of_the_test(exoid_, segments):
    run = exoid_("identify", "bleex", "walk.csv", "--test", "masked.csv", "--segments", "named.csv", *TERMS, "--json")
    assert run.code == 0, run.err
    data = json.loads(run.out)
    assert len(data["inputs"][0]["segments"]) == len(segments.segment_times)
    assert data["tests"][0]["samples"] == np.count_nonzero((segments.time >= 2.0) & (segments.time < 8.0))
