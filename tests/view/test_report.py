"""The report tells what the estimate holds, in one valid page that needs nothing beside it."""

from dataclasses import replace

import numpy as np
import pytest
from html_pages import check, undrawn

import exoid
from exoid.experiments.excitation import assess
from exoid.signals import Source
from exoid.tables import DataTable
from exoid.torques import Armature, Coulomb, NonlinearParameter, Offset, Stribeck, Viscous
from exoid.view.report import Embedded, Page, Section, Words, identification_report, picture
from exoid.view.report import text as words
from exoid.view.report.evidence import gather
from exoid.view.report.pictures import prediction_pictures


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
    assert f"{estimate.identifiability.count('well')} well determined" in words
    assert all(f"{100 * error:.1f} %" in words for error in nrmse)


def test_without_a_held_out_recording_the_report_says_so(swing):
    data, estimate = swing
    with undrawn():
        assert "not tested" in " ".join(identification_report(estimate, [data.train]).verdict)


def test_where_everything_comes_from_is_told(page, swing):
    _, estimate = swing
    text = text_of(check(page.html()))
    assert estimate.inputs[0].sha256 in text
    assert "Estimator: wls" in text
    assert "zero-phase" in text


@pytest.fixture(scope="module")
def short(swing):
    """Too short a recording for too many parameters, its estimate, and the page's text."""
    part = swing[0].train.slice(0, 700)
    estimate = exoid.identify(swing[0].leg, part, (*exoid.torques.DEFAULT_TERMS, exoid.Stiffness()))
    with undrawn():
        return part, estimate, text_of(check(identification_report(estimate, [part]).html()))


def test_what_is_not_determined_is_named_with_what_it_trades_against(short):
    _, estimate, text = short
    poor = [name for name, verdict in zip(estimate.names, estimate.identifiability, strict=True) if verdict != "well"]
    assert poor
    assert all(f"{name} is " in text for name in poor)
    assert "trades most against" in text


def test_the_advice_is_that_of_assessing_the_recordings(short):
    """Gravity at small hip angles does not tell a spring; the report names the experiment that does."""
    part, estimate, text = short
    assert estimate.identifiability[estimate.names.index("b1_hip")] != "well"
    found = assess(estimate.model.leg, part, estimate.model.terms, noise=estimate.residual_rms).advice
    tilt = next(each for each in found if "b1_hip" in each.parameters)
    assert tilt.what in text
    assert "b1_hip from" in text


@pytest.fixture(scope="module")
def particular(swing):
    """An estimate with everything that is told beside parameters, and the page about it."""
    data, _ = swing
    parts = [replace(data.train.slice(k * 1000, (k + 1) * 1000), source=Source(f"run{k}.csv", f"{k}")) for k in (0, 1)]
    terms = (Coulomb(), Stribeck(velocity=NonlinearParameter(0.1, 0.01, 1.0)), Viscous(), Armature(), Offset())
    prior = exoid.regression.Prior({"J3": (0.05, 1e-4)})
    estimate = exoid.identify(data.leg, parts, terms, known={"X1": 3.98}, prior=prior, nonnegative=True)
    with undrawn():
        return estimate, identification_report(estimate, parts)


def test_what_was_known_and_believed_is_told_and_nothing_is_advised_for_it(particular):
    estimate, page = particular
    assert set(estimate.identifiability) >= {"known", "prior"}
    text = text_of(check(page.html()))
    assert "Known: X1 = 3.98" in text
    assert "Prior: J3 = 0.05 ± 0.0001" in text
    assert "1 held at what is known" in " ".join(page.verdict)
    assert estimate.bounded
    assert f"Kept at zero: {', '.join(estimate.bounded)}" in text
    assert "X1 is " not in text
    assert "brings X1" not in text


def test_fitted_settings_stand_below_the_parameters(particular):
    estimate, page = particular
    rows = [[cell.text for cell in row] for row in check(page.html()).find(".//table").iter("tr")]
    assert [row[0] for row in rows[1:]] == [*estimate.names, *estimate.nonlinear.names]
    settings = rows[-len(estimate.nonlinear) :]
    np.testing.assert_allclose([float(row[1]) for row in settings], estimate.nonlinear.values, rtol=5e-2)


def test_every_recordings_part_is_told(particular):
    estimate, page = particular
    tables = {table.findtext("caption"): table for table in check(page.html()).iter("table")}
    rows = [[cell.text for cell in row] for row in tables["What each recording contributes"].find("tbody")]
    assert [row[0] for row in rows] == ["run0.csv", "run1.csv"]
    for row, change in zip(rows, estimate.influence.change, strict=True):
        moved = change[estimate.names.index(row[2])]
        assert row[3] in (f"{moved:+.1f}".replace("-", "−"), "not known without")


def test_residuals_that_depend_on_velocity_are_told_with_a_hint(swing):
    """Without Coulomb friction the residual has its shape."""
    data, estimate = swing
    poor = exoid.identify(data.leg, data.train, (Viscous(), Offset()))
    text = " ".join(words.dependence(poor))
    assert "depends on its velocity by more than noise explains" in text
    assert "friction is not of the form of the terms" in text
    assert words.dependence(estimate)[0].startswith("No residual depends on velocity or angle")


def test_a_leg_without_friction_terms_has_no_friction_section(swing):
    data, _ = swing
    rigid = exoid.identify(data.leg, data.train, (Offset(),))
    with undrawn():
        titles = [section.title for section in identification_report(rigid, [data.train]).sections]
    assert "Friction" not in titles
    assert "What the model leaves over" in titles


def test_bands_contain_as_many_new_torques_as_they_say(swing):
    """On data of the same leg; and far fewer where the leg is another."""
    data, estimate = swing
    np.testing.assert_allclose(gather(estimate, data.test).inside, 0.95, atol=0.03)
    loaded = replace(data.test, tau=data.test.tau + np.array([1.0, 0.5, 0.2]))
    assert (gather(estimate, loaded).inside < 0.1).all()


def test_friction_is_what_the_terms_say_and_what_the_torque_has_beside_the_rest():
    """A leg of known friction: what is measured less the rest is that friction, filtered."""
    leg = exoid.load_leg("bleex")
    time = np.arange(3000) / 100.0
    q = 0.3 * np.sin(np.outer(time, [1.0, 1.7, 2.3])) + [0.3, -0.7, 0.0]
    v = 0.3 * np.array([1.0, 1.7, 2.3]) * np.cos(np.outer(time, [1.0, 1.7, 2.3]))
    a = -0.3 * np.array([1.0, 1.7, 2.3]) ** 2 * np.sin(np.outer(time, [1.0, 1.7, 2.3]))
    friction = 2.0 * np.tanh(v / 0.02) + 0.7 * v
    noise = 0.01 * np.random.default_rng(3).standard_normal(q.shape)
    tau = leg.inverse_dynamics(q, v, a) + friction + noise
    recording = exoid.Recording(time, q, v, a, tau, joint_names=leg.joint_names)
    estimate = exoid.identify(leg, recording, (Coulomb(), Viscous()))
    found = gather(estimate, recording)
    start = len(time) // 2 - len(found.friction) // 2
    expected = estimate.preparation.filter(friction, 100.0)[start : start + len(found.friction)]
    np.testing.assert_allclose(found.friction, expected, atol=0.05)
    np.testing.assert_allclose(found.measured_friction, expected, atol=0.08)


def test_a_long_recording_is_drawn_by_a_few_thousand_points(swing):
    data, estimate = swing
    fast = data.test
    time = np.linspace(fast.time[0], fast.time[-1], 20 * len(fast))
    columns = {
        name: np.column_stack([np.interp(time, fast.time, x) for x in getattr(fast, name).T]) for name in ("q", "tau")
    }
    thick = exoid.Recording(time, columns["q"], tau=columns["tau"], joint_names=fast.joint_names)
    thin, thick = (list(prediction_pictures(estimate, gather(estimate, each))) for each in (fast, thick))
    assert all(len(more.svg) < 1.5 * len(less.svg) for more, less in zip(thick, thin, strict=True))


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
