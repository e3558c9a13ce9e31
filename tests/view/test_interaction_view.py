"""The torque of the wearer in figures and in the report."""

from worn import log, push, swing, unworn_estimate

import exoid
from exoid.view.report import interaction_report


def test_the_report_shows_every_joint_and_the_findings(leg):
    estimate, motion = unworn_estimate(leg), swing(leg, 7, seconds=12.0)
    recording = log(motion, push(motion))
    found = exoid.interaction(estimate, recording)
    page = interaction_report(estimate, found)
    assert page.sections[0].title == "Torque of the wearer"
    over_time = next(section for section in page.sections if section.title == "Over time")
    assert len(over_time.blocks) == len(found.joint_names)
    short = exoid.interaction(estimate, recording.between(recording.time[0], recording.time[0] + 1.0))
    assert "Findings" in [section.title for section in interaction_report(estimate, short).sections]
