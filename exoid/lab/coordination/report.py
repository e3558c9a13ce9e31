"""Report of a day: modes and delays by function, switches, planted faults, and the figure of torques and contacts."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from exoid.control.functions import contact_name
from exoid.lab.reproduce.report import Drawing, ReplayReport
from exoid.tools.json_values import attributes, json_value
from exoid.tools.tables import DataTable
from exoid.view.coordination import DayPart, plot_day

from .study import CoordinationStudy


def coordination_report(study: CoordinationStudy) -> ReplayReport:
    """Report a study: sentences, a table of functions, JSON and the figure of the day.

    Args:
        study: The study.

    Returns:
        The report.
    """
    functions = {
        name: {
            **attributes(score, "accuracy", "samples", "certain", "transitions"),
            "delay_p95": json_value(score.delay),
        }
        for name, score in study.functions.items()
    }
    events = attributes(study.events, "cases", "beyond_limits", "ended") | {"support_in_air": study.events.in_air}
    data = attributes(study, "mode_accuracy", "switches", "seat_off", "seed")
    data |= {"functions": functions, "events": events}
    rows = [
        (
            name,
            f"{100.0 * score.accuracy:.2f}",
            f"{score.samples}",
            f"{100.0 * score.certain:.1f}",
            "–" if np.isnan(score.delay) else f"{1e3 * score.delay:.0f}",
            f"{score.transitions}",
        )
        for name, score in study.functions.items()
    ]
    headers = ("function", "mode right [%]", "blocks", "certain [%]", "delay, 95 % [ms]", "changes")
    table = DataTable("Contacts further than 100 ms from a transition, and delays of single contacts", headers, rows)
    switches = [(name, f"{100.0 * x:.2f}") for name, x in study.switches.items()]
    return ReplayReport(
        title=f"A day of {study.name} (seed {study.seed})",
        about="Contacts are told from joint torques and the IMU by the identified model; a servo tracks the functions.",
        findings=[_findings(study)],
        tables=[
            table,
            DataTable("Mode right while walking and climbing [%]", ("foot switches", "mode right"), switches),
        ],
        data=data,
        drawings={"day": Drawing("Torques and contacts over the day", lambda figure: _draw(figure, study), 1.9, 2.0)},
    )


def _findings(study: CoordinationStudy) -> list[str]:
    events = study.events
    found = [f"The set of contacts is right in {100.0 * study.mode_accuracy:.2f} % of the day."]
    if study.seat_off:
        found.append(f"Seat-off is found {1e3 * max(study.seat_off):.0f} ms late at most.")
    if events.cases:
        found.append(
            f"In {events.cases} planted faults {events.beyond_limits} torques were beyond their bounds, and "
            f"{events.in_air} times a leg in the air was to bear load for more than 60 ms; "
            + ", ".join(
                f"{count} ended with {name}" if name != "followed" else f"{count} went on"
                for name, count in events.ended.items()
            )
            + "."
        )
    return found


def _draw(figure: Figure, study: CoordinationStudy) -> None:
    parts = []
    for episode, belief in zip(study.episodes, study.beliefs, strict=True):
        run = episode.run
        names = [contact_name(run.plant.leg, link) for link in run.plant.soles]
        force = {name: foot.force[:, 2] for name, foot in zip(names, run.feet.values(), strict=True)}
        every = len(run.time) // len(belief.probability)
        ends = (np.arange(len(belief.probability)) + 1) * every - 1
        told = {name: belief.wrench[:, k, 1] * (belief.wrench[:, k] != 0.0).any(axis=1) for k, name in enumerate(names)}
        parts.append(DayPart(episode.function.name, run.time, run.tau, force, run.time[ends], told))
    plot_day(figure, parts, study.plant.leg.joint_names)
