"""Which contacts hold is told from the rows of the identified machine, whatever the switches say."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from exoid import ExoidError, load_leg
from exoid.control.ground import ContactFilter
from exoid.experiments.ground import bleex_machine
from exoid.lab.coordination import day, study
from exoid.rig.ground import Sole
from exoid.torques.model import TorqueModel

pytestmark = pytest.mark.slow


def filter_of(plant, soles):
    """The filter that knows the machine to 1 %."""
    model, truth = TorqueModel(plant.leg, study.TERMS), plant.values
    values = np.array([truth[name] for name in model.names])
    return ContactFilter(model, values, np.diag((0.01 * values) ** 2), soles, np.array(study.SENSORS.imu_position))


@pytest.fixture(scope="module")
def told():
    """Episodes by name with their filter and log."""
    plant, out = bleex_machine(), {}
    for name, seconds in (("walk", 5.0), ("rise", 3.0)):
        episode = day.run_function(plant, name, seconds, np.random.default_rng(1))
        log = episode.run.recording(study.SENSORS, np.random.default_rng([1, 300]), wrenches=(plant.root_link,))
        out[name] = filter_of(plant, episode.run.plant.soles), episode, log
    return out


@pytest.mark.parametrize("name", ["walk", "rise"])
def test_the_set_of_contacts_is_right_further_than_100_ms_from_a_transition(told, name):
    contacts, episode, log = told[name]
    right, far = study._judge(contacts, episode, study.over(contacts, log, {}))
    assert far.sum() > 150
    assert right[far].mean() > 0.99
    assert max(study._delays(contacts, episode, study.over(contacts, log, {})), default=0.0) <= 0.06


@pytest.mark.parametrize(
    "fault", [np.ones_like, np.zeros_like, lambda x: np.roll(x, 40)], ids=["closed", "open", "late"]
)
def test_a_wrong_switch_does_not_fool_it(told, fault):
    contacts, episode, log = told["walk"]
    switches = {"left_foot": fault(log.contacts["left_foot"]), "right_foot": log.contacts["right_foot"]}
    right, far = study._judge(contacts, episode, study.over(contacts, log, switches))
    assert right[far].mean() > 0.99


def test_forces_are_judged_by_the_identified_weight_not_by_that_of_the_urdf(told):
    contacts, *_ = told["walk"]
    heavier = contacts.values * np.where(np.array(contacts.model.names) == "M", 1.3, 1.0)
    model, values = contacts.model, (contacts.values, heavier)
    light, heavy = (ContactFilter(model, x, contacts.covariance, contacts.soles, contacts.imu_position) for x in values)
    np.testing.assert_allclose(heavy.prior, 1.3 * light.prior)


def test_the_seat_is_told_to_be_left_within_60_ms(told):
    contacts, episode, log = told["rise"]
    (delay,) = study._seat_off([contacts], [episode], [study.over(contacts, log)])
    assert delay <= 0.06


def test_what_a_function_expects_is_no_proof(told):
    """A function that never leaves the chair, or one that never sits, does not hide that the seat is left."""
    contacts, episode, log = told["rise"]
    both = frozenset(("left", "right"))
    for expected in ({both}, {both | {"seat"}}):
        belief = contacts.advance(contacts.begin(), study.readings_of(contacts, log), expected)
        right, far = study._judge(contacts, episode, belief)
        assert right[far].mean() > 0.95
        free = study.over(contacts, log).probability
        likelier = [each in expected for each in contacts.chances(free[0])]
        assert belief.probability[:, :-1][:, likelier].sum() > free[:, :-1][:, likelier].sum()


def test_forces_are_told_beside_the_set(told):
    """Upward force on the foot that bears, by the middle of single support, to 5 % of the weight."""
    contacts, episode, log = told["walk"]
    belief = study.over(contacts, log)
    ends = study._blocks(contacts, len(log))
    true = episode.run.feet["left_foot"].force[ends, 2]
    single = np.convolve(episode.truth()["right"][ends], np.ones(21), "same") == 0
    error = (belief.wrench[:, 0, 1] - true)[single]
    assert single.sum() > 20
    assert np.sqrt(np.mean(error**2)) < 0.05 * 9.81 * 49.1


@pytest.mark.parametrize("bits", [12, 14])
def test_an_encoder_of_few_bits_is_not_frozen_and_one_that_stops_is_told_soon(told, bits):
    contacts, _, log = told["walk"]
    readings, step = study.readings_of(contacts, log), 2.0 * np.pi / 2**bits
    q = step * np.round(readings.q / step)
    whole = contacts.advance(contacts.begin(), readings._replace(q=q)).probability
    assert (whole[:, -1] < 0.5).mean() > 0.98
    q[1000:, 1] = q[1000, 1]
    assert (contacts.advance(contacts.begin(), readings._replace(q=q)).probability[210:, -1] > 0.5).mean() > 0.9
    q[:, 1] = q[0, 1]  # from the beginning
    assert (contacts.advance(contacts.begin(), readings._replace(q=q)).probability[150:, -1] > 0.5).all()


def test_a_frozen_sensor_makes_contacts_unknown_until_it_changes(told):
    contacts, episode, log = told["walk"]
    readings = study.readings_of(contacts, log)
    q = readings.q.copy()
    q[1000:, 1] = q[1000, 1]
    belief = contacts.advance(contacts.begin(), readings._replace(q=q))
    others = np.delete(episode.run.v[study._blocks(contacts, len(q))], 1, axis=1)
    fast = np.abs(others).max(axis=1) > 1.0
    late = np.arange(len(belief.probability)) > 210
    assert (belief.probability[fast & late, -1] > 0.5).mean() > 0.9
    assert (belief.probability[220:, -1] > 0.5).mean() > 0.98  # at rest, too
    q[1500:] = readings.q[1500:]
    assert (contacts.advance(contacts.begin(), readings._replace(q=q)).probability[350:, -1] < 0.5).mean() > 0.9


made = partial(SimpleNamespace, model=None, values=(), covariance=())
REFUSED = {
    "no base": lambda plant: ContactFilter.of(made(leg=load_leg("bleex")), plant.soles),
    "no soles": lambda plant: ContactFilter.of(made(leg=plant.leg), {}),
    "four soles": lambda plant: ContactFilter.of(
        made(leg=plant.leg), {f"s{k}": Sole.flat(0.0, 0.1, 0.0) for k in range(4)}
    ),
    "fast": lambda plant: ContactFilter.of(made(leg=plant.leg), plant.soles, rate=100.0),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_told_is_refused(name):
    with pytest.raises(ExoidError):
        REFUSED[name](bleex_machine())


def test_a_reading_that_is_not_finite_is_refused(told):
    contacts, _, log = told["walk"]
    readings = study.readings_of(contacts, log)
    for name in ("tau", "known"):
        with pytest.raises(ExoidError, match="finite"):
            contacts.advance(contacts.begin(), readings._replace(**{name: np.full_like(readings.tau, np.nan)}))
