"""Controllers that use the estimates of a study, on the same leg: as in the closed loop alone, and reproducibly."""

import json
import warnings
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import exoid
from exoid.control import ControlModel, simulate_law
from exoid.control.standard_laws import SENSORS
from exoid.errors import ExoidError
from exoid.experiments import cuhk, gait_for_leg, healthy_gait
from exoid.experiments.excitation import MotionLimits
from exoid.experiments.excitation.scales import Scales
from exoid.lab.study import (
    LegText,
    Noise,
    Protocol,
    Study,
    TrackingTask,
    plausible_truth,
    run_study,
)
from exoid.lab.study.design import TrackingCase
from exoid.lab.study.replicates import run_chunk
from exoid.lab.study.tracking_runs import track_cases
from exoid.torques import DEFAULT_TERMS, TorqueModel
from exoid.torques.catalog import term_by_name

LEG = exoid.load_leg("cuhk")
MODEL = TorqueModel(LEG, DEFAULT_TERMS)
TRUTH = plausible_truth(MODEL, Scales.of(MODEL, MotionLimits.of(LEG)).typical_torque)
KNOWN = ControlModel.of_parameters(MODEL, np.array(TRUTH))
PERIOD = 1.6
GAIT = gait_for_leg(LEG, healthy_gait(0.5, PERIOD))
RMS, PEAK, TORQUE = range(3)


def course(*laws, **gains):
    return TrackingTask.of(laws, GAIT, PERIOD, KNOWN, **gains)


def study(**changes):
    motion = cuhk.multisine(LEG, np.random.default_rng(0), draws=20)
    protocol = Protocol("multisine", (motion,), 6.0, (0.0,))
    noise = Noise("white", (1.0, 1.0))
    plain = Study(LegText.of(LEG), DEFAULT_TERMS, TRUTH, (protocol,), (noise,), replicates=4, chunk=2, seed=4)
    return replace(plain, **{"course": course("pd", "feedforward_pd"), **changes})


@pytest.fixture(scope="module")
def result():
    return run_study(study())


def same(one, other):
    return json.dumps(one.to_json()) == json.dumps(other.to_json()) and str(one) == str(other)


def figures(result, law, knows):
    (found,) = [each for each in result.laws if (each.law, each.knows) == (law, knows)]
    return found


def test_controllers_use_the_truth_and_each_estimate_but_pd_nothing():
    what = study(course=course("pd", "lqr"), estimators=("wls", "ols"))
    assert what.tracking_cases == (("pd", "nothing"), ("lqr", "truth"), ("lqr", "wls"), ("lqr", "ols"))
    assert study(course=None).tracking_cases == ()


@pytest.mark.slow
def test_pd_and_a_controller_with_the_true_parameters_do_the_same_as_in_the_closed_loop(result):
    """The rig by itself is stepped by Pinocchio and has other noise, which PD hardly feels."""
    asked = study().course
    for name, knows in (("pd", "nothing"), ("feedforward_pd", "truth")):
        law = asked.law(name, KNOWN)
        alone = simulate_law(KNOWN.plant(), law, GAIT, 2 * PERIOD, sensors=SENSORS, settle=PERIOD, seed=0)
        found = figures(result, name, knows)
        near = 0.01 if name == "pd" else 0.1
        np.testing.assert_allclose(found.rms_deg.mean, alone.rms_deg, rtol=near)
        np.testing.assert_allclose(found.peak_deg.mean, alone.peak_deg, rtol=3.0 * near)
        np.testing.assert_allclose(found.rms_torque.mean, alone.rms_torque, rtol=0.01)


@pytest.mark.slow
def test_figures_are_those_of_the_runs(result):
    """From the chunks by hand; the excess is of one replicate over the same with the truth."""
    tracking = np.concatenate([run_chunk(study(), number).tracking for number in range(2)], axis=1)
    truth, estimated = (
        study().tracking_cases.index(TrackingCase("feedforward_pd", source)) for source in ("truth", "wls")
    )
    found = figures(result, "feedforward_pd", "wls")
    np.testing.assert_array_equal(found.rms_deg.mean, tracking[estimated, :, RMS].mean(axis=0))
    np.testing.assert_array_equal(found.peak_deg.worst, tracking[estimated, :, PEAK].max(axis=0))
    np.testing.assert_array_equal(found.rms_torque.std, tracking[estimated, :, TORQUE].std(axis=0, ddof=1))
    excess = tracking[estimated, :, RMS] - tracking[truth, :, RMS]
    np.testing.assert_array_equal(found.excess_deg.mean, excess.mean(axis=0))
    assert found.diverged == 0
    assert figures(result, "pd", "nothing").excess_deg is None


@pytest.mark.slow
def test_knowing_the_leg_helps_and_knowing_it_badly_helps_less(result):
    """PD alone is worst; estimates track less well than the truth, the more so the more noise."""
    pairs = ("pd", "nothing"), ("feedforward_pd", "truth"), ("feedforward_pd", "wls")
    blind, exact, estimated = (figures(result, law, knows).rms_deg.mean for law, knows in pairs)
    assert (blind > 5.0 * estimated).all()
    assert (estimated > exact).all()
    quiet = run_study(study(noises=(Noise("white", (1e-3, 1e-3)),), replicates=2))
    excess = figures(quiet, "feedforward_pd", "wls").excess_deg
    assert np.abs(excess.mean).max() < 0.01 * (estimated - exact).min()


def test_all_cases_of_a_replicate_have_the_same_noise():
    """Estimates equal to the truth give exactly the runs of the controller with the true parameters."""
    what = study(course=course("feedforward_pd"))
    one = exoid.identify(LEG, exoid.Recording(*_exact(), joint_names=LEG.joint_names), cutoff=40.0)
    exact = replace(one, values=np.array(TRUTH))
    tracking = track_cases(what, what.chunks[0], {"wls": [exact, exact]})
    np.testing.assert_array_equal(tracking[0], tracking[1])
    assert (tracking[0, 0] != tracking[0, 1]).any()  # replicates do not


def _exact():
    motion, time = cuhk.multisine(LEG, np.random.default_rng(0), draws=20), np.arange(500) / 100.0
    states = Protocol("m", (motion,), 4.99, (0.0,)).states(0, 100.0)
    return time, *states, MODEL.regressor(*states) @ np.array(TRUTH)


@pytest.mark.slow
def test_a_law_that_diverges_is_counted_and_leaves_the_others_alone():
    """PD far too stiff for its rate; LQR has gains of its own."""
    wild = TrackingTask.of(("pd", "lqr"), GAIT, PERIOD, KNOWN, kp=(1e7,), kd=(1e6,))
    found = run_study(study(course=wild, replicates=2))
    lost, fine = figures(found, "pd", "nothing"), figures(found, "lqr", "truth")
    assert (lost.diverged, fine.diverged) == (2, 0)
    alone = figures(run_study(study(course=course("lqr"), replicates=2)), "lqr", "truth")
    np.testing.assert_allclose(fine.runs, alone.runs, rtol=1e-6)
    data = json.loads(json.dumps(found.to_json(), allow_nan=False))
    assert data["laws"][0]["joints"]["hip"]["rms_deg"] == {"mean": None, "std": None, "worst": None}
    assert "Diverged, and not counted: pd (nothing): 2." in str(found)


def test_an_estimate_without_a_controller_is_counted_as_lost(monkeypatch):
    """The Riccati equation has no solution for some parameters; here one replicate is made to fail."""
    what = study(course=course("lqr"))
    one = exoid.identify(LEG, exoid.Recording(*_exact(), joint_names=LEG.joint_names), cutoff=40.0)
    sound, odd = replace(one, values=np.array(TRUTH)), replace(one, values=1.5 * np.array(TRUTH))
    make = TrackingTask.law

    def refusing(self, name, known):
        if ControlModel.of(known).coulomb[0] > 1.2 * KNOWN.coulomb[0]:
            raise ExoidError("no stabilising gain")
        return make(self, name, known)

    monkeypatch.setattr(TrackingTask, "law", refusing)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tracking = track_cases(what, what.chunks[0], {"wls": [odd, sound]})
    assert np.isnan(tracking[1, 0]).all()
    assert np.isfinite(tracking[1, 1]).all()
    assert np.isfinite(tracking[0]).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: course("magic"), "no controller magic"),
        (course, "no controller at all"),
        (lambda: course("pd", "pd"), "pd, pd"),
        (lambda: course("pd", kp=(1.0, 2.0, 3.0)), "gains of 3 joints for a leg of 2"),
        (lambda: study(course=course("pd", kp=(-1.0,))), "gains"),
        (lambda: replace(course("pd"), periods=1), "1 periods"),
        (lambda: study(course=replace(course("pd"), kp=(1.0,))), "1 Kp and 2 Kd"),
        (lambda: study(course=replace(course("pd"), motion=gait_for_leg(LEG, healthy_gait(5.0)))), "the motion asks"),
        (lambda: study(estimators=("wls", "wls")), "name each once"),
    ],
)
def test_invalid_tracking_tasks_are_refused(make, words):
    with pytest.raises(ExoidError, match=words):
        make()


def test_terms_that_no_rig_has_are_refused():
    terms = (*DEFAULT_TERMS, term_by_name("stribeck"))
    model = TorqueModel(LEG, terms)
    truth = plausible_truth(model, Scales.of(model, MotionLimits.of(LEG)).typical_torque)
    with pytest.raises(ExoidError, match="the rig has no such friction"):
        study(terms=terms, truth=truth)


@pytest.fixture
def quick(monkeypatch):
    """Strides of 4 s."""
    monkeypatch.setattr("exoid.cli.study.PERIOD", 4.0)


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_the_command_prints_laws_as_a_table_or_json(exoid_):
    options = ["--replicates", "2", "--duration", "12", "--protocols", "document", "--noise", "0.3"]
    run = partial(exoid_, "study", "cuhk", *options)
    code, out, _ = run("--laws", "feedforward_pd", "--kp", "80,20", "--kd", "8", "-o", "kept")
    assert code == 0
    assert "wls, knee" in out
    assert "hip 80 / 8, knee 20 / 8" in out
    code, again, _ = run("--laws", "feedforward_pd", "--kp", "80,20", "--kd", "8", "-o", "kept", "--json")
    found = json.loads(again)["laws"][1]
    assert (found["law"], found["knows"], found["diverged"]) == ("feedforward_pd", "wls", 0)
    assert 0.0 < found["joints"]["knee"]["rms_deg"]["mean"] < 1.0
    for wrong, words in (
        (("--laws", "pd,magic"), "computed_torque"),
        (("--laws", "pd", "--kp", "stiff"), "--kp stiff"),
        (("--course", "gait"), "--course has no effect"),
        (("--kd", "3"), "--kd has no effect"),
    ):
        code, out, err = run(*wrong)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert words in err


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_a_leg_that_has_no_gait_follows_a_plan(exoid_, tmp_path):
    """Joints of another name: the error says which option helps."""
    text = LEG.description.text.replace("left_hip", "left_shoulder").replace("left_knee", "left_elbow")
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    options = ["arm.urdf", "--joints", "left_shoulder,left_elbow", "--replicates", "2", "--duration", "12"]
    for more, code in (((), 2), (("--course", "planned"), 0)):
        ran = exoid_("study", *options, "--laws", "pd", *more)
        assert ran.code == code
        assert "--course planned" in ran.err if code else "nothing," in ran.out


def test_an_adaptive_controller_runs_in_a_study():
    """Whether it begins with the truth or with estimates, it tracks far better than PD."""
    found = run_study(study(course=course("pd", "adaptive"), replicates=2))
    pd = figures(found, "pd", "nothing")
    for knows in ("truth", "wls"):
        learned = figures(found, "adaptive", knows)
        assert learned.diverged == 0
        assert (np.array(learned.rms_deg.mean) < 0.2 * np.array(pd.rms_deg.mean)).all()
