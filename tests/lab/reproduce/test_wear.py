"""``exoid wear``: what a wearer feels of a leg that is off, and with CAD, identified and true model."""

from dataclasses import replace

import numpy as np
import pytest
from swings import harmonics, log_of

import exoid
from exoid import ExoidError, published, reproduce
from exoid.errors import BadArgumentError
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.lab.reproduce import wear_models
from exoid.lab.reproduce.wear_study import _inertia_and_friction
from exoid.lab.stability import largest_amplification
from exoid.rig import Plant


@pytest.fixture(scope="module")
def worn(estimate):
    """BLEEX with the estimate of the example, which is found faster than that of the replay."""
    return reproduce.wear(estimate)


@pytest.mark.nightly
def test_the_identified_model_is_felt_like_the_truth_and_far_less_than_cad():
    felt = reproduce.wear_report(reproduce.wear("bleex")).data["felt_rms"]
    assert felt["identified"] <= 0.2 * felt["cad"]
    assert felt["identified"] <= 1.3 * felt["truth"]
    assert felt["cad"] < felt["off"]


@pytest.mark.nightly
def test_cad_limits_the_amplification_more_than_the_estimate(worn):
    found = reproduce.wear_report(worn).data
    assert found["largest_amplification"]["cad"] < 10.0 < found["largest_amplification"]["identified"]
    assert found["amplification"]["cad"] == pytest.approx(0.9 * found["largest_amplification"]["cad"])


@pytest.mark.nightly
def test_an_estimate_is_worn_on_a_rig_of_its_own_distribution(exoid_, saved, tmp_path):
    found = exoid_("wear", "est.json", "--json", "--figures", "figures", "--period", "2.5").data
    felt = found["felt_rms"]
    assert {"cad", "identified"} <= set(found["largest_amplification"])
    assert list(felt) == ["off", "cad", "identified", "truth"]
    assert felt["identified"] <= 1.3 * felt["truth"]
    assert (tmp_path / "figures" / "felt_torque.pdf").stat().st_size > 1e4


def test_the_floor_is_the_torque_that_pinocchio_says(leg):
    plant = Plant.build(leg, {"d_knee": 0.5}, end_stops=False)
    motion = gait_for_leg(leg, healthy_gait(0.8, 3.0))
    times = np.linspace(0.0, 3.0, 2000, endpoint=False)
    q, v, a = (np.array([getattr(motion.at(t), name)[:, 0] for t in times]) for name in ("q", "v", "a"))
    still = np.zeros_like(q)
    torque = leg.inverse_dynamics(q, v, a) - leg.inverse_dynamics(q, still, still) + v * [0.0, 0.5, 0.0]
    rms = np.sqrt((torque**2).mean(axis=0))
    assert np.allclose(_inertia_and_friction(plant, motion, 3.0), rms, rtol=1e-3)


@pytest.fixture
def cuhk(monkeypatch):
    """Models of CUHK, of which a short log is identified."""
    monkeypatch.setattr(wear_models, "identify_cuhk", lambda *_: exoid.identify(*_short_cuhk()))
    return wear_models.worn_models("cuhk", 0, lambda _: None)


def test_a_model_that_is_unstable_without_amplification_is_refused_by_name(cuhk):
    """Also where the largest amplifications are given, as of another stride."""
    found = largest_amplification(cuhk.cad, truth=cuhk.cad, poses=[0.2, 0.7])
    given = {"identified": found, "cad": replace(found, values=np.zeros(1)), "truth": found}
    with pytest.raises(ExoidError, match="with the cad model the worn leg is unstable"):
        reproduce.wear(cuhk, largest=given)


def test_no_model_drives_a_passive_joint(cuhk):
    """Else CAD and truth seem to help at a joint without an actuator, where an identified model cannot."""
    inputs = tuple(replace(one, passive=("left_knee",)) for one in cuhk.identified.inputs)
    found = largest_amplification(cuhk.cad, truth=cuhk.cad, poses=[0.2, 0.7])
    passive = cuhk._replace(identified=replace(cuhk.identified, inputs=inputs))
    given = dict.fromkeys(("cad", "identified", "truth"), found)
    felt = reproduce.wear(passive, period=1.5, largest=given).felt
    assert all(np.abs(each.run.tau[:, 1]).max() < 1e-9 for each in felt.values())
    assert min(np.abs(felt[name].run.tau[:, 0]).max() for name in ("cad", "identified", "truth")) > 1.0


def test_the_cad_of_cuhk_lacks_friction_and_errs_in_its_bodies(cuhk):
    assert dict(zip(cuhk.cad.parameter_names, cuhk.cad.parameters, strict=True)) == pytest.approx(
        published.cuhk_cad_parameters()
    )
    assert cuhk.truth.parameters[2, 0] == pytest.approx(published.cuhk_parameters()["J1"] + 0.8, rel=0.02)
    assert wear_models.worn_models(cuhk, 0, lambda _: None) is cuhk


def _short_cuhk():
    """Leg and a short log of it, for an estimate of any quality."""
    leg, time = exoid.load_leg("cuhk"), np.arange(0.0, 10.0, 0.01)
    return leg, log_of(leg, time, harmonics(time, 1.0, np.array([[4.0], [7.0]]), 0.0), noise=0.1), ()


@pytest.mark.parametrize("given", [{"source": "hal"}, {"period": -1.0}, {"most": 1.0}])
def test_what_makes_no_sense_is_refused_before_anything_runs(given):
    with pytest.raises(BadArgumentError):
        reproduce.wear(**({"source": "bleex"} | given))
