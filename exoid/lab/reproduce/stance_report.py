"""Report of the study of stance: what each way cannot know, ground forces, walking, and parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from exoid.estimate.finding import Finding
from exoid.tools.json_values import attributes, json_value, named
from exoid.tools.tables import DataTable
from exoid.view.colours import MEASURED, PREDICTED
from exoid.view.style import draw_band, legend_above

from .report import Drawing, ReplayReport, estimate_cells, estimate_json
from .stance import Disturbed, StanceReplay, relative_error

FORCE_KEYS = {
    "motion": "motion",
    "link": "link",
    "vertical_rms": "force",
    "of_weight": "relative",
    "centre_of_pressure_rms": "pressure",
    "within_band": "inside",
}
"""Attribute of a ForceError for each key of the JSON."""


def stance_report(replay: StanceReplay) -> ReplayReport:
    """Report the study: findings, a summary, ground forces, walking, and parameters by three ways.

    Args:
        replay: Replay of the study.

    Returns:
        The report.
    """
    walks = {**replay.walk.estimates, "alone": replay.walk.alone}
    caption = "Vertical ground force: force plate, and prediction from joint torques by the estimate without plates"
    drawing = Drawing(caption, lambda figure: _draw_forces(figure, replay), height=1.4, width=2.0)
    return ReplayReport(
        title=f"BLEEX on the ground (seed {replay.seed})",
        about="A virtual BLEEX with known parameters swings, squats, stands on one foot and walks. It is identified in "
        "three ways.",
        findings=[_findings(replay)],
        tables=[stance_summary(replay), _forces_table(replay), _walk_table(replay), stance_parameters(replay)],
        data={
            "truth": dict(replay.truth),
            "estimates": {way: _way_json(replay, way) for way in replay.estimates},
            "forces": [
                {key: json_value(getattr(each, name)) for key, name in FORCE_KEYS.items()} for each in replay.forces
            ],
            "walk": {
                "estimates": {name: estimate_json(each) for name, each in walks.items()},
                "fixed_torso": [_finding_json(finding) for finding in replay.walk.fixed],
                **attributes(replay.walk, "seconds", "bias_error"),
            },
            "wrong_labels": _disturbed_json(replay.wrong),
            "slipping": _disturbed_json(replay.slipping),
            "seed": replay.seed,
        },
        drawings={"stance_ground_force": drawing},
    )


def stance_parameters(replay: StanceReplay) -> DataTable:
    """Make a table of the parameters of the rigid bodies: truth and three estimates."""
    rows = []
    for name in replay.leg.parameter_names:
        cells = [name, replay.estimates["plates"][name].unit, f"{replay.truth[name]:.4g}"]
        for way, estimate in replay.estimates.items():
            known = name in estimate.names
            true = replay.true_value(way, name)
            cells += estimate_cells(estimate, name, true, relative=True) if known else ("refused", "", "")
        rows.append(cells)
    columns = (header for way in replay.estimates for header in (way, "± std", "error"))
    return DataTable(
        "BLEEX, both legs and torso: truth, and estimates from swing, with stance and force plates, and without plates",
        ("parameter", "unit", "truth", *columns),
        rows,
    )


def stance_summary(replay: StanceReplay) -> DataTable:
    """Make a table of the largest errors and the coverage of each way."""
    rows = [
        (
            way,
            *(_percent(replay.largest(way, symbol)) for symbol in "MXJ"),
            f"{100.0 * replay.coverage(way):.0f}",
            "M, X0, Y0, J0" if way == "swing" else "–",
        )
        for way in replay.estimates
    ]
    headers = ("estimate", "M [%]", "X, largest [%]", "J, largest [%]", "in 95 % interval [%]", "cannot know")
    return DataTable("Errors over the truth, and share of the parameters within their intervals", headers, rows)


def _forces_table(replay: StanceReplay) -> DataTable:
    rows = [
        (
            f"{each.motion}, {each.link}",
            f"{each.force:.2f}",
            f"{100.0 * each.relative:.2f}",
            f"{1e3 * each.pressure:.1f}",
            f"{100.0 * each.inside:.0f}",
        )
        for each in replay.forces
    ]
    headers = ("motion", "vertical [N]", "of weight [%]", "centre of pressure [mm]", "within band [%]")
    return DataTable("Ground force from joint torques, without plates, on unseen motions: rms error", headers, rows)


def _walk_table(replay: StanceReplay) -> DataTable:
    """X, Y and J of the legs from a walk."""
    walk, rows = replay.walk, []
    for name, unit in zip(walk.estimates["left"].names, walk.estimates["left"].units, strict=True):
        if name[0] in "XYJ":
            cells = [name, unit]
            for side, estimate in walk.estimates.items():
                true = replay.truth[f"{name}_{side}"]
                cells += [f"{true:.4g}", *estimate_cells(estimate, name, true, relative=True)]
            rows.append(cells)
    columns = (header for side in walk.estimates for header in (f"true {side}", side, "± std", "error"))
    seconds = " and ".join(f"{time:.1f} s" for time in walk.seconds.values())
    title = f"Swing rows of a walk ({seconds}); friction and rotors are those of the estimate without plates"
    return DataTable(title, ("parameter", "unit", *columns), rows)


def _findings(replay: StanceReplay) -> list[str]:
    """Say what each way cannot know, and what wrong logs do."""
    walk = replay.walk
    kinds = ", ".join(dict.fromkeys(finding.kind for finding in walk.fixed)) or "no finding"
    return [
        f"Without force plates the total mass is {_percent(replay.largest('no plates', 'M'))} % off.",
        f"Swing alone: {replay.refused}.",
        "On the held torso J1 includes the rotor of the hip, as no motion separates the two.",
        f"With a torso that is taken for fixed, the log of the walk has the findings {kinds}.",
        f"The bias of the IMU was taken out of swing and walk as squats told it, to {walk.bias_error:.1g} m/s² (rms).",
        "The walk alone, friction and rotors unknown: "
        f"M {_percent(walk_error(replay, 'M'))} %, X {_percent(walk_error(replay, 'X'))} %, "
        f"J {_percent(walk_error(replay, 'J'))} % at most; each stride is the same motion.",
        f"Wrong labels at 5 % of the samples of stance move parameters by at most {replay.wrong.moved:.1f} standard "
        f"deviations ({replay.wrong.parameter}); findings report {100.0 * replay.wrong.share:.1f} %.",
        f"Feet that slip move parameters by at most {replay.slipping.moved:.1f} standard deviations "
        f"({replay.slipping.parameter}); findings report {100.0 * replay.slipping.share:.1f} %.",
    ]


def walk_error(replay: StanceReplay, symbol: str) -> float:
    """Find the largest relative error of "M", "X" or "J" of the estimate from the walk alone."""
    alone = replay.walk.alone
    errors = alone.values - np.array([replay.truth[name] for name in alone.names])
    return relative_error(alone.names, errors, replay.truth, symbol)


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{100.0 * share:.2g}"


def _draw_forces(figure: Figure, replay: StanceReplay) -> None:
    """Draw measured and predicted ground forces with their bands."""
    axes = figure.subplots(len(replay.forces), 1, sharex=True, squeeze=False)[:, 0]
    for ax, each in zip(axes, replay.forces, strict=True):
        shown = each.time - each.time[0] < 6.0  # a squat and a shift
        time, predicted = each.time[shown], each.predicted[shown]
        ax.plot(time, each.measured[shown], color=MEASURED, lw=0.4, label="force plate")
        draw_band(ax, time, predicted, each.half[shown])
        ax.plot(time, predicted, color=PREDICTED, label="from joint torques")
        ax.set_ylabel("vertical force [N]")
        ax.set_title(f"{each.motion}, {each.link.replace('_', ' ')}", loc="right")
    legend_above(axes[0])
    axes[-1].set_xlabel("time [s]")


def _way_json(replay: StanceReplay, way: str) -> dict[str, Any]:
    estimate = replay.estimates[way]
    return estimate_json(estimate) | {
        "interval": named(estimate.names, estimate.interval(0.95)),
        "errors": named(estimate.names, replay.errors(way)),
        "coverage": replay.coverage(way),
        "largest": {symbol: json_value(replay.largest(way, symbol)) for symbol in "MXJ"},
        "refused": replay.refused if way == "swing" else None,
    }


def _disturbed_json(each: Disturbed) -> dict[str, Any]:
    findings = [_finding_json(finding) for finding in each.findings]
    return attributes(each, "moved", "parameter", "share") | {"findings": findings}


def _finding_json(finding: Finding) -> dict[str, Any]:
    return attributes(finding, "kind", "joint", "severity", "value", "message")
