"""An estimate cannot be changed, prints itself, and survives a file to the last bit."""

import json
from pathlib import Path

import lxml.html
import numpy as np
import pytest
from made_estimates import from_file
from swings import TERMS, Swing

import exoid
from exoid import Armature, Coulomb, Estimate, ExoidError, Leg, Offset, Stiffness, Validation, Viscous
from exoid.estimate.compared import TorqueFilter
from exoid.estimate.data import Input
from exoid.signals import FiniteDifference, MovingAverage, ZeroPhase
from exoid.torques import TorqueModel
from exoid.torques.position_units import TURNS

GOLDEN = Path(__file__).parent / "golden"
NOISE = np.array([0.3, 0.2, 0.1])
EVERY_TERM = (
    Coulomb(dead_band=0.01),
    Viscous(),
    Armature(),
    Offset(joints=("hip",)),
    Stiffness(degree=1, joints=("knee",)),
)


@pytest.fixture(scope="module")
def swing():
    return Swing(exoid.load_leg("bleex", "right", "identified"), base=0.15)


@pytest.fixture(scope="module")
def recording(swing):
    return swing.with_noise(np.random.default_rng(0), NOISE)


@pytest.fixture(scope="module")
def estimate(swing, recording):
    return exoid.identify(swing.leg, recording, EVERY_TERM)


def hand_made(condition_number=42.0):
    """An estimate of round numbers, the same on every machine."""
    model = TorqueModel(exoid.load_leg("cuhk"), (Coulomb(), Armature()))
    std = np.array([0.0123, 0.00456, 0.1, 1.0, 0.02, 0.3, 2e-7, 12.0, 0.0])
    values = np.array([4.252, 0.09, 1.516, 1.52, -0.04, 0.598, 1.4449999, 123.4, 0.1])
    sources = (Input("first.csv", "ab" * 32, 3000, 100.0), Input("array", "cd" * 32, 500, 250.0))
    residual, how = np.array([0.25, 0.0125]), ZeroPhase(5.0)
    return Estimate(model, values, np.diag(std**2), condition_number, 1234.5, residual, "ols", how, sources)


def same(golden, text):
    """Compare with a file in golden/; delete the file and run once to renew it, then look at the difference."""
    path = GOLDEN / golden
    if not path.exists():
        path.write_text(text + "\n", encoding="utf-8")
        pytest.fail(f"{golden} was missing and has been written: look at it, and commit it")
    assert text + "\n" == path.read_text(encoding="utf-8")


def test_an_estimate_prints_values_intervals_units_and_remarks():
    same("estimate.txt", str(hand_made()))


def test_the_example_prints_as_in_the_readme(data):
    same("bleex_swing.txt", str(exoid.identify(data.leg, data.train)))


def test_a_validation_prints_one_line_a_joint():
    time = np.arange(4) / 10.0
    measured = np.array([[1.0, 2.0], [3.0, 2.0], [1.0, 2.0], [3.0, 2.0]])
    predicted = measured + np.array([0.5, 0.25])
    half = np.full((4, 2), [0.6, 0.2])
    low_pass = TorqueFilter(ZeroPhase(8.0), "of the estimate", "8 Hz, chosen by the noise of the angles")
    name = "a_rather_long_file_name_of_a_log.csv"
    how = {"half_width": half, "filter": low_pass, "wrench_torque": np.zeros((4, 2)), "units": (TURNS, TURNS)}
    validation = Validation(("hip", "knee"), time, measured, predicted, name, **how)
    same("validation.txt", str(validation))
    assert repr(validation) == "Validation(nrmse: hip 0.500, knee nan)"


def test_the_identified_leg_is_the_rigid_part_of_the_torque(estimate, swing):
    """est.torque less the columns of the terms is Pinocchio's RNEA of est.leg."""
    q, v, a = swing.motion
    count = len(estimate.leg.parameter_names)
    rest = estimate.model.regressor(q, v, a)[..., count:] @ estimate.values[count:]
    rigid = estimate.torque(q, v, a) - rest
    np.testing.assert_allclose(estimate.leg.inverse_dynamics(q, v, a), rigid, atol=1e-10)
    np.testing.assert_allclose(estimate.leg.parameters, estimate.values[:count], rtol=1e-12)
    assert np.abs(rest).max() > 0.5


@pytest.mark.parametrize("preparation", [ZeroPhase(6.0, 11.0), FiniteDifference(), MovingAverage(0.4)])
def test_a_file_gives_the_estimate_back_to_the_last_bit(swing, recording, preparation, tmp_path):
    estimate = exoid.identify(swing.leg, recording, EVERY_TERM, "ols", preparation=preparation)
    loaded = from_file(estimate, tmp_path)
    q, v, a = swing.motion
    assert loaded.to_json() == estimate.to_json()  # all that a file has
    assert (loaded.torque(q, v, a) == estimate.torque(q, v, a)).all()
    assert (loaded.leg.inverse_dynamics(q, v, a) == estimate.leg.inverse_dynamics(q, v, a)).all()
    assert (loaded.interval(0.9) == estimate.interval(0.9)).all()
    assert (loaded.preparation, loaded.model.terms) == (estimate.preparation, estimate.model.terms)
    assert str(loaded) == str(estimate)


def test_a_file_needs_no_urdf(recording, tmp_path):
    """The URDF is inside: the original may be gone, and locked joints stay locked."""
    urdf = tmp_path / "mine.urdf"
    urdf.write_bytes((exoid.catalog.urdf_folder() / "bleex_identified.urdf").read_bytes())
    leg = Leg.from_urdf(urdf, ("right_hip", "right_knee"), locked={"right_ankle": 0.2}, cumulative=False)
    estimate = exoid.identify(leg, recording, TERMS)
    urdf.unlink()
    loaded = from_file(estimate, tmp_path)
    assert loaded.model.leg.locked == {"right_ankle": 0.2}
    np.testing.assert_array_equal(loaded.model.leg.parameters, leg.parameters)
    np.testing.assert_array_equal(loaded.leg.parameters, estimate.leg.parameters)


def test_the_file_is_json_without_extensions_and_names_every_value(estimate, tmp_path):
    estimate.save(tmp_path / "leg.json")

    def refuse(constant):
        raise AssertionError(constant)

    data = json.loads((tmp_path / "leg.json").read_text(encoding="utf-8"), parse_constant=refuse)
    assert data["schema"] == "exoid-estimate-2"
    assert tuple(data["values"]) == tuple(data["std"]) == tuple(data["units"]) == estimate.names
    assert data["interval_95"]["X1"] == estimate.interval()[0].tolist()
    assert data["leg"]["sha256"] == estimate.model.leg.description.sha256


DELETE = object()

DAMAGE = {
    "another schema": (("schema",), "exoid-estimate-99"),
    "a value missing": (("values", "J1"), DELETE),
    "a value that is text": (("values", "J1"), "heavy"),
    "values as a list": (("values",), [1.0, 2.0]),
    "covariance too small": (("covariance",), [[1.0]]),
    "covariance with NaN": (("covariance", 0, 0), float("nan")),
    "a negative variance": (("covariance", 0, 0), -1.0),
    "no degrees of freedom": (("degrees_of_freedom",), 0),
    "condition number null": (("condition_number",), None),
    "residual of a joint missing": (("residual_rms", "right_hip"), DELETE),
    "an unknown term": (("terms", 0, "term"), "magic"),
    "a term with an unknown setting": (("terms", 0, "magic"), 1.0),
    "a term with an impossible setting": (("terms", 0, "smoothing"), -1.0),
    "an unknown preparation": (("preparation", "name"), "magic"),
    "a cut-off that is text": (("preparation", "cutoff"), "eight"),
    "an input with a strange field": (("inputs", 0, "colour"), "red"),
    "noise of a joint missing": (("evidence", "noise", 0), DELETE),
    "noise with a strange field": (("evidence", "noise", 0, "colour"), "pink"),
    "whiteness null": (("evidence", "noise", 0, "whiteness"), None),  # this and the next two: found by property tests
    "samples as text": (("inputs", 0, "samples"), "many"),
    "a size missing": (("evidence", "parameter_scale", 0), DELETE),
    "a warning that is a number": (("warnings",), [1]),
    **{f"no {name}": ((name,), DELETE) for name in ("leg", "warnings", "prior", "evidence")},
    **{f"no {name}": (("evidence", name), DELETE) for name in ("noise", "parameter_scale", "collinearity")},
    "joints that the URDF lacks": (("leg", "joints", 0), "tail"),
    "a locked joint that the URDF lacks": (("leg", "locked"), {"tail": 0.0}),
    "a URDF that is none": (("leg", "urdf"), "<robot/>"),
    "a URDF that was changed": (("leg", "sha256"), "0" * 64),
}


@pytest.mark.parametrize("damage", DAMAGE, ids=lambda name: name.replace(" ", "-"))
def test_a_damaged_file_is_refused(estimate, tmp_path, damage):
    path, value = DAMAGE[damage]
    data = json.loads(json.dumps(estimate.to_json()))
    place = data
    for key in path[:-1]:
        place = place[key]
    if value is DELETE:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    file = tmp_path / "leg.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(ExoidError) as e:
        Estimate.load(file)
    assert str(file) in str(e.value)
    assert "\n" not in str(e.value)


def test_a_parameter_is_looked_up_by_name(estimate):
    for k, name in enumerate(estimate.names):
        found = estimate[name]
        assert (found.name, found.value, found.std) == (name, estimate.values[k], estimate.std[k])
        assert found.interval == tuple(estimate.interval()[k])
        assert (found.unit, found.identifiability) == (estimate.units[k], estimate.identifiability[k])
    assert "X1" in estimate
    assert list(estimate)[:3] == ["X1", "Y1", "J1"]
    assert str(estimate["X1"]).startswith("X1 = ")
    with pytest.raises(ExoidError, match=r"no parameter 'X9'.*names are X1, Y1"):
        estimate["X9"]
    assert "X9" not in estimate


def test_results_show_themselves_as_tables_in_notebooks(swing, recording, estimate):
    """The same cells and lines as in the printed text, in HTML that an XML parser reads, with nothing unescaped."""
    validation = exoid.validate(estimate, recording)
    grouped = exoid.identify(swing.leg, {"<a>": recording}, TERMS, own="c0")
    for result in (estimate, validation, grouped):
        page, text = lxml.html.fragment_fromstring(result._repr_html_(), create_parent="div"), str(result)
        cells = [cell.text_content() for cell in page.iter("td")]
        assert len(cells) > 5
        assert all(cell in text for cell in cells)
        assert all(" ".join(line.text_content().split()) in " ".join(text.split()) for line in page.iter("p"))
    assert "<a>" not in grouped._repr_html_()
