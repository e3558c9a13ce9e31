"""``exoid track``: laws side by side on an estimate and on BLEEX, and document 2's comparison."""

from functools import partial

import numpy as np
import pytest
from controlled_legs import estimate_of

import exoid
from exoid import control, published
from exoid.control.standard_laws import SENSORS
from exoid.estimate import Estimate
from exoid.experiments import healthy_gait
from exoid.torques import Armature, Coulomb, Offset, TorqueModel, Viscous

NAMES = ["pd", "gravity_friction_pd", "feedforward_pd", "computed_torque", "lqr", "self_tuning"]
METRICS = ["peak_deg", "rms_deg", "rms_torque", "torque_variation"]


@pytest.fixture
def track(exoid_):
    """Run ``exoid track ARGUMENTS`` in an empty folder."""
    return partial(exoid_, "track")


@pytest.fixture
def saved(tmp_path):
    """An estimate of document 2's leg, as if identified."""
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, (Coulomb(), Viscous(), Armature(), Offset()))
    values = {**published.cuhk_parameters(), **published.cuhk_resistances(), "Ia_knee": 0.8, "d_hip": -0.01}
    estimate_of(model, values).save(tmp_path / "est.json")
    return "est.json"


@pytest.mark.slow
def test_an_estimate_is_tracked_by_every_law(track, saved):
    done = track(saved, "--period", 1, "--json", "--seed", 5)
    assert done.err == ""
    data = done.data
    assert list(data) == ["laws", "joint_names", "torque_units", "error_units", "gains", "seed"]
    assert list(data["laws"]) == NAMES
    assert all(list(law) == METRICS for law in data["laws"].values())
    est = Estimate.load(saved)
    gait = healthy_gait(0.8, 1.0)
    kp, kd = control.default_gains(est, control.mean_pose(gait, 1.0))
    np.testing.assert_allclose(data["gains"]["kp"], kp)
    model = control.ControlModel.of(est)
    laws = control.standard_laws(est, kp, kd, gait, 1.0)
    runs = control.compare_laws(model.plant(), laws, gait, 2.0, sensors=SENSORS, settle=1.0, seed=5)
    assert runs["lqr"].peak_deg.tolist() == data["laws"]["lqr"]["peak_deg"]
    assert data["laws"]["lqr"]["peak_deg"][0] < 0.1 * data["laws"]["pd"]["peak_deg"][0]


@pytest.mark.slow
def test_a_table_and_figures(track, saved, tmp_path):
    done = track(saved, "--period", 1, "--kp", 30, "--rate", 50, "--figures", "new/figs")
    for words in ("hip 30 / 3, knee 30 / 3", *NAMES):
        assert words in done.printed
    files = sorted(path.name for path in (tmp_path / "new/figs").iterdir())
    assert done.err.count("wrote") == len(files) >= 5
    assert {"pd_errors.pdf", "pd_torques.pdf", "laws_peak_errors.pdf"} <= set(files)
    assert not any("fig" in file for file in files)  # a figure of another leg is none of a document
    starts = {name: (tmp_path / "new/figs" / name).read_bytes()[:5] for name in files}
    assert all(start == (b"%PDF-" if name.endswith(".pdf") else b"<?xml") for name, start in starts.items())


@pytest.mark.slow
def test_the_angles_of_a_log_may_be_followed(track, saved, tmp_path):
    """From its beginning to its end; its columns may have the labels of the joints."""
    time = np.arange(200) / 100.0
    q = np.column_stack([0.2 * np.sin(np.pi * time), 0.5 + 0.3 * np.cos(np.pi * time)])
    exoid.Recording(time, q, joint_names=("left_hip", "left_knee")).to_csv(tmp_path / "walk.csv")
    printed = track(saved, "--reference", "walk.csv").printed
    assert "reference of 1.99 s" in printed
    text = (tmp_path / "walk.csv").read_text(encoding="utf-8")
    (tmp_path / "labels.csv").write_text(text.replace("left_", ""), encoding="utf-8")
    for options in ((), ("--unmeasured", "knee"), ("--passive", "knee")):
        assert track(saved, "--reference", "labels.csv", *options).out == printed


def gait_log(path):
    """Text of a log of the leg of an estimate under feedforward."""
    known = control.ControlModel.of(Estimate.load(path / "est.json"))
    kp, kd = control.default_gains(known, np.array([0.2, 0.4]))
    run = control.simulate_law(
        known.plant(), control.feedforward_pd(known, 2.0 * kp, 2.0 * kd), healthy_gait(0.8, 4.0), 4.0
    )
    run.recording.to_csv(path / "log.csv")
    return (path / "log.csv").read_text()


LOGS = []
"""Text of the log, which is the same for every test."""


@pytest.fixture
def logged(saved, tmp_path):
    """The log beside the estimate."""
    LOGS[:] = LOGS or [gait_log(tmp_path)]
    (tmp_path / "log.csv").write_text(LOGS[0])
    return "log.csv"


@pytest.mark.slow
def test_a_dry_run_prints_writes_and_draws_the_torque(track, saved, logged, tmp_path):
    options = ("--limit", "20,8", "--slew", 100, "-o", "commanded.csv", "--figures", "figs")
    done = track(saved, "--dry-run", logged, *options)
    assert "gravity_support at 100 Hz would have commanded" in done.printed
    assert "wrote commanded.csv" in done.err
    assert (tmp_path / "figs" / "dry_run.pdf").read_bytes().startswith(b"%PDF")
    table = np.loadtxt(tmp_path / "commanded.csv", delimiter=",", skiprows=1)
    assert (np.abs(table[:, 1:3]).max(axis=0) <= (20.0, 8.0)).all()
    assert np.abs(np.diff(table[:, 1:3], axis=0)).max() <= 1.0 + 1e-9


@pytest.mark.parametrize("law", ["transparent", "feedforward_pd", "lqr", "self_tuning"])
def test_every_controller_has_a_dry_run(track, saved, logged, law):
    data = track(saved, "--dry-run", logged, "--law", law, "--json").data
    assert (data["law"], data["rate"]) == (law, 100.0)
    if law == "feedforward_pd":  # the model of the log's own controller
        assert data["rms_difference"][0] < 0.1 * data["rms_recorded"][0]
