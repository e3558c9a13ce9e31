"""The torque of the wearer in figures and in the report."""

import pytest
from worn import log, push, swing, unworn_estimate

import exoid
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
