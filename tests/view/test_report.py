"""The report states what the estimate holds, in one valid self-contained page."""

from dataclasses import replace

import numpy as np
import pytest
from html_pages import check, undrawn
from swings import harmonics

import exoid
from exoid.experiments.excitation import assess
from exoid.regression import Prior
from exoid.signals import Source
from exoid.tools.tables import DataTable
from exoid.torques import Armature, Coulomb, Offset, Stribeck, Viscous
from exoid.view.report import identification_report
from exoid.view.report.fit import (
    predict_recording,
    torque_pictures,
)
from exoid.view.report.page import EmbeddedPage, Page, Picture, Section, Text


@pytest.fixture(scope="module")
def swing(data):
    return data, exoid.identify(data.leg, data.train)


def undrawn_report(*arguments):
    """A report, and its tree, without drawings: its words."""
    with undrawn():
        page = identification_report(*arguments)
        return page, check(page.html())


@pytest.fixture(scope="module")
def page(swing):
    data, estimate = swing
    return undrawn_report(estimate, [data.train], [data.test])


@pytest.fixture(scope="module")
def drawn(swing):
    data, estimate = swing
    return identification_report(estimate, [data.train], [data.test])


def text_of(tree):
    return " ".join("".join(tree.itertext()).split())


@pytest.mark.slow
def test_the_report_is_a_valid_page_that_loads_nothing(drawn):
    check(drawn.html())


@pytest.mark.slow
def test_every_parameter_stands_in_the_table_with_its_interval_and_the_urdfs_value(page, swing):
    (_, tree), (_, estimate) = page, swing
    rows = {row[0].text: [cell.text for cell in row[1:]] for row in tree.find(".//table").iter("tr")}
    for name, value, bounds in zip(estimate.names, estimate.values, estimate.interval(), strict=True):
        numbers = [float(cell) for cell in (rows[name][0], *rows[name][2:4])]
        two_digits = 0.0125 * np.ptp(bounds)  # of ±
        np.testing.assert_allclose(numbers, [value, *bounds], rtol=2e-2, atol=two_digits)
    own = dict(zip(estimate.leg.parameter_names, estimate.model.leg.parameters, strict=True))
    np.testing.assert_allclose(float(rows["X1"][-1]), own["X1"], rtol=1e-3)
    assert rows["c0_hip"][-1] == "–"


@pytest.mark.slow
def test_the_summary_counts_parameters_and_gives_the_error_on_a_held_out_recording(page, swing):
    data, estimate = swing
    nrmse = exoid.validate(estimate, data.test).nrmse
    said = " ".join(page[0].summary)
    assert f"{estimate.identifiability.count('well')} well identified" in said
    assert all(f"{error:.3f}" in said for error in nrmse)


def test_inputs_and_settings_are_listed(page, swing):
    _, estimate = swing
    text = text_of(page[1])
    assert estimate.inputs[0].sha256 in text
    assert "Estimator: wls" in text
    assert "zero-phase" in text


@pytest.fixture(scope="module")
def short(swing):
    """Too short a recording for too many parameters, its estimate, and the page's text."""
    part = swing[0].train.slice(0, 700)
    estimate = exoid.identify(swing[0].leg, part, (*exoid.torques.DEFAULT_TERMS, exoid.Stiffness()))
    return part, estimate, text_of(undrawn_report(estimate, [part])[1])


def test_poorly_identified_parameters_are_named(short):
    _, estimate, text = short
    weakly = [name for name, grade in zip(estimate.names, estimate.identifiability, strict=True) if grade == "weakly"]
    assert weakly
    assert f"Weakly identified: {', '.join(weakly)}." in text


def test_the_advice_is_that_of_assessing_the_recordings(short):
    """Gravity at small hip angles resembles a spring; the report names the experiment that separates them."""
    part, estimate, text = short
    assert estimate.identifiability[estimate.names.index("b1_hip")] != "well"
    found = assess(estimate.model.leg, part, estimate.model.terms, noise=estimate.residual_rms).advice
    tilt = next(each for each in found if "b1_hip" in each.parameters)
    assert tilt.what in text
    assert "b1_hip from" in text


@pytest.fixture(scope="module")
def particular(swing):
    """An estimate with all kinds of prior knowledge, and the page about it."""
    data, _ = swing
    parts = [replace(data.train.slice(k * 1000, (k + 1) * 1000), source=Source(f"run{k}.csv", f"{k}")) for k in (0, 1)]
    terms = (Coulomb(), Stribeck(), Viscous(), Armature(), Offset())
    prior = Prior({"J3": (0.05, 1e-4)})
    estimate = exoid.identify(data.leg, parts, terms, known={"X1": 3.98}, prior=prior, nonnegative=True)
    return estimate, *undrawn_report(estimate, parts)


def test_prior_knowledge_is_listed_and_gets_no_advice(particular):
    estimate, page, tree = particular
    assert set(estimate.identifiability) >= {"known", "prior"}
    text = text_of(tree)
    assert "Known: X1 = 3.98" in text
    assert "Prior: J3 = 0.05 ± 0.0001" in text
    assert "1 fixed at a known value" in " ".join(page.summary)
    assert estimate.bounded
    assert f"Kept at zero: {', '.join(estimate.bounded)}" in text
    assert "brings X1" not in text


def test_modelled_and_measured_friction_are_those_of_the_leg(leg):
    """A leg of known friction: measured torque less the other terms is that friction, filtered."""
    time = np.arange(3000) / 100.0
    q, v, a = harmonics(time, 0.3, np.array([[1.0], [1.7], [2.3]]), 0.0)
    q += [0.3, -0.7, 0.0]
    friction = 2.0 * np.tanh(v / 0.02) + 0.7 * v
    noise = 0.01 * np.random.default_rng(3).standard_normal(q.shape)
    tau = leg.inverse_dynamics(q, v, a) + friction + noise
    recording = exoid.Recording(time, q, v, a, tau, joint_names=leg.joint_names)
    estimate = exoid.identify(leg, recording, (Coulomb(), Viscous()))
    found = predict_recording(estimate, recording)
    start = len(time) // 2 - len(found.friction) // 2
    expected = estimate.preparation.filter(friction, 100.0)[start : start + len(found.friction)]
    np.testing.assert_allclose(found.friction, expected, atol=0.05)
    np.testing.assert_allclose(found.friction + found.validation.residual, expected, atol=0.08)


@pytest.mark.slow
def test_a_long_recording_is_drawn_by_a_few_thousand_points(swing):
    data, estimate = swing
    fast = data.test
    time = np.linspace(fast.time[0], fast.time[-1], 20 * len(fast))
    columns = {
        name: np.column_stack([np.interp(time, fast.time, x) for x in getattr(fast, name).T]) for name in ("q", "tau")
    }
    thick = exoid.Recording(time, columns["q"], tau=columns["tau"], joint_names=fast.joint_names)
    thin, thick = (list(torque_pictures(estimate, predict_recording(estimate, each))) for each in (fast, thick))
    assert all(len(more.svg) < 1.5 * len(less.svg) for more, less in zip(thick, thin, strict=True))


def test_a_table_explains_each_column_once_and_leaves_no_header_empty():
    table = DataTable("errors", ["controller", "± std", "± std"], [["pd", "1", "2"], ["", "3", "4"]])
    tree = check(Page("Errors", [], [Section("Tables", [table])]).html())
    assert text_of(tree).count("standard deviation") == 1
    assert [cell.text for cell in tree.iter("th")] == ["controller", "± std", "± std", "pd"]


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


def test_a_page_is_written_whole_or_not_at_all(tmp_path):
    page = Page("Errors", ["None."], [])
    with pytest.raises(exoid.ExoidError, match="cannot be written"):
        page.save(tmp_path / "missing" / "report.html")
    page.save(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == page.html()
