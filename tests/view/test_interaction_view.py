"""The torque of the wearer in figures and in the report."""

import pytest
from matplotlib.figure import Figure
from worn import log, push, swing, unworn_estimate

import exoid
from exoid.control.wearer.gait import profile
from exoid.view import plot_interaction
from exoid.view.forces import draw_gait_profile
from exoid.view.report import interaction_report


@pytest.fixture(scope="module")
def estimate(leg):
    return unworn_estimate(leg)


@pytest.fixture(scope="module")
def recording(leg):
    motion = swing(leg, 7, seconds=12.0)
    return log(motion, push(motion))


@pytest.fixture(scope="module")
def found(estimate, recording):
    return exoid.interaction(estimate, recording)


def test_the_report_shows_every_joint_and_the_findings(estimate, recording, found):
    page = interaction_report(estimate, found)
    titles = [section.title for section in page.sections]
    assert titles[0] == "Torque of the wearer"
    over_time = next(section for section in page.sections if section.title == "Over time")
    assert len(over_time.blocks) == len(found.joint_names)
    short = exoid.interaction(estimate, recording.between(recording.time[0], recording.time[0] + 1.0))
    assert "Findings" in [section.title for section in interaction_report(estimate, short).sections]


def test_the_figures_draw_what_they_are_given(found):
    ax = Figure().add_subplot()
    plot_interaction(ax, found.time, found.torque[:, 0], found.band[:, 0], "hip")
    assert "torque of the wearer" in {line.get_label() for line in ax.lines}
    phase, figure = (found.time % 2.0) / 2.0, Figure()
    draw_gait_profile(figure, profile(found.torque, found.velocity, phase), found.joint_names)
    above, below = figure.axes
    curves = [line for line in above.lines if len(line.get_xdata()) == 20]
    assert len(curves) == len({line.get_linestyle() for line in curves}) == len(found.joint_names)
    assert below.get_ylabel() == "power on\nthe leg [W]"
