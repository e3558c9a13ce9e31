"""Input that is read, but that no leg, log or estimate can have: each ends in one line with its own cause."""

import numpy as np
import pytest
from one_joint import URDF, swing, write_urdf

import exoid
from exoid import ExoidError, Leg
from exoid.control import pd, simulate_law
from exoid.experiments import Hold
from exoid.experiments.excitation import plan_excitation
from exoid.leg.description import describe
from exoid.leg.lift import lift
from exoid.rig import Plant


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    return write_urdf(tmp_path_factory.mktemp("leg") / "one.urdf")


def test_a_number_of_a_million_digits_takes_no_longer_to_refuse_than_to_read():
    """Found by a mutated URDF of 24 kB, which took 9 s: with the square of the number of digits."""
    long = "9" * 1_000_000
    for text in (long, f"{long}x", f"{long}.{long}", f"1e{long}", f"{long} 1"):
        with pytest.raises(ExoidError, match=r"joint 'hip': <limit velocity='.*'> is not 1 finite number") as refused:
            describe(URDF.replace('velocity="6"', f'velocity="{text}"'))
        assert len(str(refused.value)) < 300


def test_times_that_a_log_does_not_have_are_refused_with_those_that_it_has(leg):
    log = swing(leg, seconds=5.0)
    for limits in ((100.0, None), (None, -1.0), (3.0, 2.0), (4.95, 8.0)):
        with pytest.raises(ExoidError, match=r"its time stamps are 0 s to 4\.99 s"):
            log.between(*limits)
    for limits in ((float("nan"), None), (None, "3")):
        with pytest.raises(ExoidError, match="a limit of"):
            log.between(*limits)
    assert len(log.between(None, 3.0)) == 300
    assert len(log.between(3.0)) == 200
    assert len(log.between()) == len(log)


def test_the_lift_of_any_finite_numbers_ends_in_a_lift_or_one_line():
    rng, refused = np.random.default_rng(0), 0
    legs = [exoid.load_leg("bleex"), exoid.load_leg("cuhk")]
    for k in range(60):
        leg = legs[k % 2]
        p = len(leg.parameters)
        values = rng.choice([-1.0, 1.0], p) * 10.0 ** rng.uniform(-300.0, 300.0 if k % 4 else 20.0, p)
        try:
            assert np.isfinite(lift(leg, values).link_parameters).all()
        except ExoidError as error:
            refused += "far from those of a leg" in str(error)
    assert refused


@pytest.mark.parametrize(("duration", "rate"), [(60.0, 1e9), (1e9, 100.0)])
def test_a_plan_of_more_samples_than_memory_is_refused_before_it_is_tried(leg, duration, rate):
    with pytest.raises(ExoidError, match="are more than 1e"):
        plan_excitation(leg, duration=duration, rate=rate)


def test_shapes_that_the_parser_does_not_understand_print_nothing(tmp_path, capfd):
    """The leg has no use for them; the parser prints four lines for each."""
    shape = '<{0}><geometry><mesh filename="a.stl" scale="nan 1 1"/></geometry></{0}>'
    shapes = shape.format("visual") + shape.format("collision")
    (tmp_path / "one.urdf").write_text(URDF.replace("<inertial>", f"{shapes}<inertial>"), encoding="utf-8")
    leg = Leg.from_urdf(tmp_path / "one.urdf")
    assert capfd.readouterr() == ("", "")
    assert "a.stl" in leg.description.text
    (tmp_path / "a.stl").touch()
    with pytest.raises(ExoidError, match="link 'thigh': <mesh scale='nan 1 1'> is not 3 finite numbers"):
        exoid.view.scene(leg, meshes=tmp_path)


@pytest.mark.parametrize("seconds", [1e12, float("inf")])
def test_runs_without_end_are_refused(leg, seconds):
    plant = Plant.build(leg, {}, end_stops=False)
    with pytest.raises(ExoidError, match="the number of samples of the run is"):
        simulate_law(plant, pd(50.0, 5.0), Hold([0.1]), seconds)
