"""The report tells what the estimate holds, in one valid page that needs nothing beside it."""

import numpy as np
import pytest
from html_pages import check

import exoid
from exoid.tables import DataTable
from exoid.view.report import Embedded, Page, Section, Words, identification_report, picture


@pytest.fixture(scope="module")
def swing():
    data = exoid.datasets.bleex_swing()
    return data, exoid.identify(data.leg, data.train)


@pytest.fixture(scope="module")
def page(swing):
    data, estimate = swing
    return identification_report(estimate, [data.train], [data.test])


def text_of(tree):
    return " ".join("".join(tree.itertext()).split())


def test_the_report_is_a_valid_page_that_loads_nothing(page):
    check(page.html())


def test_every_parameter_stands_in_the_table_with_its_interval_and_the_urdfs_value(page, swing):
    _, estimate = swing
    tree = check(page.html())
    rows = {row[0].text: [cell.text for cell in row[1:]] for row in tree.find(".//table").iter("tr")}
    for name, value, bounds in zip(estimate.names, estimate.values, estimate.interval(), strict=True):
        numbers = [float(cell) for cell in (rows[name][0], *rows[name][2:4])]
        np.testing.assert_allclose(numbers, [value, *bounds], rtol=2e-2, atol=2e-4)
    own = dict(zip(estimate.leg.parameter_names, estimate.model.leg.parameters, strict=True))
    np.testing.assert_allclose(float(rows["X1"][-1]), own["X1"], rtol=1e-3)
    assert rows["c0_hip"][-1] == "–"


def test_the_verdict_counts_and_says_how_well_an_unseen_recording_is_predicted(page, swing):
    data, estimate = swing
    nrmse = exoid.validate(estimate, data.test).nrmse
    words = " ".join(page.verdict)
    assert f"{estimate.verdicts.count('well')} well determined" in words
    assert all(f"{100 * error:.1f} %" in words for error in nrmse)


def test_without_a_held_out_recording_the_report_says_so(swing):
    data, estimate = swing
    assert "not tested" in " ".join(identification_report(estimate, [data.train]).verdict)


def test_where_everything_comes_from_is_told(page, swing):
    _, estimate = swing
    text = text_of(check(page.html()))
    assert estimate.inputs[0].sha256 in text
    assert "Estimator: wls" in text
    assert "zero-phase" in text


def test_what_is_not_determined_is_named_with_what_it_trades_against(swing):
    data, _ = swing
    estimate = exoid.identify(data.leg, data.train.slice(0, 700), (*exoid.torques.DEFAULT_TERMS, exoid.Stiffness()))
    poor = [name for name, verdict in zip(estimate.names, estimate.verdicts, strict=True) if verdict != "well"]
    assert poor
    text = text_of(check(identification_report(estimate, [data.train.slice(0, 700)]).html()))
    assert all(f"{name} is " in text for name in poor)
    assert "trades most against" in text


def test_the_same_estimate_gives_the_same_page(page, swing):
    data, estimate = swing
    assert identification_report(estimate, [data.train], [data.test]).html() == page.html()


def test_names_from_files_cannot_break_the_page():
    evil = "<script>alert(1)</script>\"'&"
    parts = [
        Words([evil]),
        DataTable(evil, [evil, "b"], [[evil, "1"]]),
        Embedded(f"<!DOCTYPE html><title>{evil}</title>", evil),
        picture(lambda figure: figure.add_subplot(), evil, evil),
    ]
    html = Page(evil, [evil], [Section(evil, parts)]).html()
    tree = check(html)
    assert not list(tree.iter("script"))
    assert tree.findtext(".//h1") == evil


def test_the_page_is_written_whole_or_not_at_all(page, tmp_path):
    with pytest.raises(exoid.ExoidError, match="cannot be written"):
        page.write(tmp_path / "missing" / "report.html")
    page.write(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == page.html()
