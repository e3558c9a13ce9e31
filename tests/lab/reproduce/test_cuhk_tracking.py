"""Document 2's comparison of controllers: what it reports, what explains it, and what beats it.

The leg is identified from noisy data of the rig; laws know the estimate, never the truth. Two seeds are tested at
night, ten with ``EXOID_FULL_STUDIES=1``.
"""

import os

import numpy as np
import pytest
from study_wrong_models import compare, table_iii_model

from exoid import reproduce
from exoid.control import gravity_friction_pd
from exoid.errors import ExoidError
from exoid.lab.reproduce.cuhk_tracking import GAINS, tracking_plant
from exoid.lab.reproduce.tracking_report import cuhk_tracking_report

pytestmark = pytest.mark.slow

ROTORS = (0.8, 0.0)
FULL = os.environ.get("EXOID_FULL_STUDIES") == "1"
MORE_SEEDS = range(1, 11 if FULL else 2)


@pytest.fixture(scope="session")
def laws(tracking):
    return tracking["json"]["laws"]


def assert_within(law, hip, knee):
    peak = law["peak_deg"]
    print(f"peak {peak[0]:.2f} / {peak[1]:.2f}, allowed {hip} / {knee}")
    assert peak[0] <= hip
    assert peak[1] <= knee


def assert_pd_is_the_documents(laws):
    """15° and 12° within half a degree, at 30 Hz and at 100."""
    for name in ("pd", "pd_30hz"):
        np.testing.assert_allclose(laws[name]["peak_deg"], [15.0, 12.0], atol=0.5)


def assert_the_law_explains_it(laws):
    slow, pd = (np.array(laws[name]["peak_deg"]) for name in ("pd_30hz", "pd"))
    assert (np.abs(slow - pd) < 0.5).all()
    assert_within(laws["gravity_friction_pd"], 10.0, 5.0)


def assert_what_beats_it(laws):
    assert_within(laws["feedforward_pd"], 1.2, 0.5)
    assert_within(laws["computed_torque"], 4.0, 1.0)
    assert_within(laws["lqr"], 0.3, 0.2)
    assert_within(laws["self_tuning"], 1.2, 0.5)


def assert_robust(rotor=0.8, seed=0):
    wrong = {name: run.to_json() for name, run in compare(seed, rotor).items()}
    for factor in ("0.5", "1.5"):
        assert_within(wrong[f"feedforward_pd F x{factor}"], 2.0, 1.0)
        assert_within(wrong[f"lqr F x{factor}"], 0.6, 0.4)
        assert_within(wrong[f"self_tuning F x{factor}"], 1.4, 0.6)
    assert_within(wrong["lqr +1.5kg"], 1.0, 1.1)  # one gain: 5 % more at the knee than gains along the gait
    assert_within(wrong["self_tuning +1.5kg"], 1.0, 1.0)


@pytest.mark.nightly
def test_pd_reproduces_the_documents_peak_errors(laws):
    assert_pd_is_the_documents(laws)


def test_the_law_and_not_the_rate_explains_the_gain(laws):
    """At equal gains 30 and 100 Hz differ by less than 0.5°; compensation beats the document's 10° and 5°."""
    assert_the_law_explains_it(laws)


def test_what_beats_the_document_at_its_own_gains(laws):
    assert_what_beats_it(laws)


@pytest.mark.nightly
@pytest.mark.parametrize("rotor", ROTORS)
def test_wrong_friction_and_an_unknown_weight_cost_little(rotor):
    assert_robust(rotor)


def test_one_law_of_each_wrong_model(tracking, laws):
    """Half the friction costs little; Table III as printed is worse than PD."""
    names = ("lqr F x0.5", "gravity_friction_pd Table III")
    runs = compare(names=names, estimate=tracking["estimate"])
    friction, printed = (runs[name].to_json() for name in names)
    assert_within(friction, 0.6, 0.4)
    assert (np.array(printed["peak_deg"]) > 1.2 * np.array(laws["pd"]["peak_deg"])).all()
    assert (np.array(printed["rms_deg"]) > np.array(laws["pd"]["rms_deg"])).all()


def test_comparable_power_is_not_what_is_found(tracking, laws):
    """The hip's rms torque is several times PD's, as PD of such gains lets the leg hang; the report says so."""
    ratio = np.array(laws["gravity_friction_pd"]["rms_torque"]) / laws["pd"]["rms_torque"]
    assert ratio[0] > 3.0
    assert 1.0 < ratio[1] < 2.0
    assert f"takes {ratio[0]:.1f} / {ratio[1]:.1f} times the rms torque of PD" in tracking["text"]


@pytest.mark.nightly
@pytest.mark.parametrize("rotor", ROTORS if FULL else ROTORS[:1])
@pytest.mark.parametrize("seed", MORE_SEEDS)
def test_other_seeds_show_the_same(seed, rotor):
    data = cuhk_tracking_report(reproduce.reproduce_cuhk_tracking(seed, rotor)).data
    assert_pd_is_the_documents(data["laws"])
    assert_the_law_explains_it(data["laws"])
    assert_what_beats_it(data["laws"])
    assert_robust(rotor, seed)


def test_table_iii_warns():
    with pytest.warns(UserWarning, match=r"hip: -1\.445.*knee: -0\.5929.*Table III"):
        gravity_friction_pd(table_iii_model(), **GAINS)


@pytest.mark.parametrize("rotor", [-0.1, np.nan, np.inf])
def test_impossible_rotors_are_refused(rotor):
    with pytest.raises(ExoidError, match="rotors"):
        tracking_plant(rotor)
