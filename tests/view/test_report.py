"""The report states what the estimate holds, in one valid self-contained page."""

from dataclasses import replace

import numpy as np
import pytest
from html_pages import check, undrawn
from swings import harmonics, log_of

import exoid
from exoid.experiments.excitation import assess
from exoid.tools.tables import DataTable
from exoid.torques import Coulomb, Viscous
from exoid.view import scene
from exoid.view.report import identification_report
from exoid.view.report.blocks import sentence
from exoid.view.report.fit import predict_recording
from exoid.view.report.page import EmbeddedPage, Page, Picture, Section, Text


def undrawn_report(*arguments):
    """A report, and its tree, without drawings: its words."""
    with undrawn():
        page = identification_report(*arguments)
        return page, check(page.html())


@pytest.fixture(scope="module")
def page(data, estimate):
    return undrawn_report(estimate, [data.train], [data.test])


@pytest.fixture(scope="module")
def drawn(data, estimate):
    return identification_report(estimate, [data.train], [data.test])


def text_of(tree):
    return " ".join("".join(tree.itertext()).split())


@pytest.mark.slow
def test_the_report_is_a_valid_page_that_loads_nothing(drawn):
    check(drawn.html())


@pytest.mark.slow
def test_every_parameter_stands_in_the_table_with_its_interval_and_the_urdfs_value(page, estimate):
    _, tree = page
    rows = {row[0].text: [cell.text for cell in row[1:]] for row in tree.find(".//table").iter("tr")}
    for name, value, bounds in zip(estimate.names, estimate.values, estimate.interval(), strict=True):
        numbers = [float(cell) for cell in (rows[name][0], *rows[name][2:4])]
        two_digits = 0.0125 * np.ptp(bounds)  # of ±
        np.testing.assert_allclose(numbers, [value, *bounds], rtol=2e-2, atol=two_digits)
    own = dict(zip(estimate.leg.parameter_names, estimate.model.leg.parameters, strict=True))
    np.testing.assert_allclose(float(rows["X1"][-1]), own["X1"], rtol=1e-3)
    assert rows["c0_hip"][-1] == "–"


@pytest.mark.slow
def test_the_summary_counts_parameters_and_gives_the_error_on_a_held_out_recording(page, data, estimate):
    nrmse = exoid.validate(estimate, data.test).nrmse
    said = " ".join(page[0].summary)
    assert f"{estimate.identifiability.count('well')} well identified" in said
    assert all(f"{error:.3f}" in said for error in nrmse)


@pytest.fixture(scope="module")
def short(data):
    """Too short a recording for too many parameters, its estimate, and the page's text."""
    part = data.train.slice(0, 700)
    estimate = exoid.identify(data.leg, part, (*exoid.torques.DEFAULT_TERMS, exoid.Stiffness()))
    return part, estimate, text_of(undrawn_report(estimate, [part])[1])


def test_the_advice_is_that_of_assessing_the_recordings(short):
    """Gravity at small hip angles resembles a spring; the report names the experiment that separates them."""
    part, estimate, text = short
    assert estimate.identifiability[estimate.names.index("b1_hip")] != "well"
    found = assess(estimate.model.leg, part, estimate.model.terms, noise=estimate.residual_rms).advice
    tilt = next(each for each in found if "b1_hip" in each.parameters)
    assert tilt.what in text
    assert "b1_hip from" in text


def test_modelled_and_measured_friction_are_those_of_the_leg(leg):
    """A leg of known friction: measured torque less the other terms is that friction, filtered."""
    time = np.arange(3000) / 100.0
    q, v, a = harmonics(time, 0.3, np.array([[1.0], [1.7], [2.3]]), 0.0)
    q += [0.3, -0.7, 0.0]
    friction = 2.0 * np.tanh(v / 0.02) + 0.7 * v
    recording = log_of(leg, time, (q, v, a), friction, 0.01, 3, exact=True)
    estimate = exoid.identify(leg, recording, (Coulomb(smoothing=0.02, reversal_speed=0.0), Viscous()))
    found = predict_recording(estimate, recording)
    start = len(time) // 2 - len(found.friction) // 2
    inner = slice(20, -20)  # towards the ends, the filter of rows sees nothing beyond them
    expected = estimate.preparation.filter(friction, 100.0)[start : start + len(found.friction)][inner]
    np.testing.assert_allclose(found.friction[inner], expected, atol=0.05)
    np.testing.assert_allclose((found.friction + found.validation.residual)[inner], expected, atol=0.08)


def test_names_from_files_cannot_break_the_page():
    evil = "<script>alert(1)</script>\"'&"
    parts = [
        Text([evil]),
        DataTable(evil, [evil, "b"], [[evil, "1"]]),
        EmbeddedPage(f"<!DOCTYPE html><title>{evil}</title>", evil),
        Picture(lambda figure: figure.add_subplot(), evil, evil),
    ]
    html = Page(evil, [evil], [Section(evil, parts)]).html()
    tree = check(html)
    assert not list(tree.iter("script"))
    assert tree.findtext(".//h1") == evil


def test_a_sentence_keeps_the_names_that_it_begins_with():
    assert [sentence(clause) for clause in ("mcx_thigh is rough", "warning: none")] == [
        "mcx_thigh is rough.",
        "Warning: none.",
    ]


def test_inertias_that_no_export_writes_are_noted(estimate):
    assert scene(estimate).notes == ()
    (note,) = scene(replace(estimate, values=20.0 * estimate.values)).notes
    assert "beyond a factor of 5" in note
