"""Study of stance as tables, as JSON, as figures and as a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.estimate.finding import Finding
from exoid.tools.tables import DataTable, to_text, with_error
from exoid.view import paper
from exoid.view.colours import MEASURED, PREDICTED
from exoid.view.report import Page, Picture, Section, Text
from exoid.view.style import COLUMN, legend_above

from .report import as_list
from .stance import Disturbed, ForceError, StanceReplay, WalkReplay, relative_error

SHOWN = 6.0
"""Longest part of a motion that is drawn [s]."""


def stance_text(replay: StanceReplay) -> str:
    """Print the study: findings, a summary, ground forces, walking, and parameters by three ways.

    Args:
        replay: Replay of the study.

    Returns:
        Text of several lines.
    """
    tables = (stance_summary(replay), stance_forces(replay), stance_walk(replay), stance_parameters(replay))
    return to_text(*as_list(stance_notes(replay)), "", *tables)


def stance_parameters(replay: StanceReplay) -> DataTable:
    """Make a table of the parameters of the rigid bodies: truth and three estimates."""
    rows = [
        (name, f"{replay.truth[name]:.4g}", *(cell for way in replay.estimates for cell in _cells(replay, way, name)))
        for name in replay.leg.parameter_names
    ]
    headers = ["parameter", "truth"]
    for way in replay.estimates:
        headers += [way, "± std", "error"]
    return DataTable(
        "BLEEX, both legs and torso: truth, and estimates from swing, with stance and force plates, and without plates",
        headers,
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
    headers = ("estimate", "M", "X, largest", "J, largest", "in 95 % interval", "cannot know")
    return DataTable("Errors in % of the truth, and parameters within their intervals in %", headers, rows)


def stance_forces(replay: StanceReplay) -> DataTable:
    """Make a table of predicted ground forces."""
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


def stance_walk(replay: StanceReplay) -> DataTable:
    """Make a table of X, Y and J of the legs from a walk."""
    walk, rows = replay.walk, []
    for name in next(iter(walk.estimates.values())).names:
        if name[0] in "XYJ":
            cells: list[str] = []
            for side, estimate in walk.estimates.items():
                true = replay.truth[f"{name}_{side}"]
                cells += [f"{true:.4g}", *_estimate_cells(estimate, name, true)]
            rows.append((name, *cells))
    headers = ["parameter"]
    for side in walk.estimates:
        headers += [f"true {side}", side, "± std", "error"]
    seconds = " and ".join(f"{time:.1f} s" for time in walk.seconds.values())
    title = f"Swing rows of a walk ({seconds}); friction and rotors are those of the estimate without plates"
    return DataTable(title, headers, rows)


def stance_notes(replay: StanceReplay) -> list[str]:
    """Say what each way cannot know, and what wrong logs do."""
    walk = replay.walk
    kinds = ", ".join(dict.fromkeys(finding.kind for finding in walk.fixed)) or "no finding"
    return [
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


def stance_json(replay: StanceReplay) -> dict[str, Any]:
    """Convert the study to JSON types.

    Args:
        replay: Replay of the study.

    Returns:
        What the tables and notes print.
    """
    return {
        "truth": dict(replay.truth),
        "estimates": {way: _way_json(replay, way) for way in replay.estimates},
        "forces": [_force_json(each) for each in replay.forces],
        "walk": _walk_json(replay.walk),
        "wrong_labels": _disturbed_json(replay.wrong),
        "slipping": _disturbed_json(replay.slipping),
        "seed": replay.seed,
    }


def stance_figures(replay: StanceReplay) -> dict[str, Figure]:
    """Draw measured and predicted ground forces with their bands.

    Args:
        replay: Replay of the study.

    Returns:
        Figures by name.
    """
    with paper():
        figure = Figure(figsize=(2.0 * COLUMN, 1.4 * COLUMN))
        axes = figure.subplots(len(replay.forces), 1, sharex=True, squeeze=False)[:, 0]
        for ax, each in zip(axes, replay.forces, strict=True):
            plot_ground_force(ax, each)
        legend_above(axes[0])
        axes[-1].set_xlabel("time [s]")
        return {"stance_ground_force": figure}


def plot_ground_force(ax: Axes, each: ForceError) -> Axes:
    """Plot the vertical ground force on a foot: measured, predicted from joint torques, and the 95 % band."""
    shown = each.time - each.time[0] < SHOWN
    time, low, high = each.time[shown], each.predicted - each.half, each.predicted + each.half
    ax.plot(time, each.measured[shown], color=MEASURED, lw=0.4, label="force plate")
    ax.fill_between(time, low[shown], high[shown], color=PREDICTED, alpha=0.35, lw=0, label="95 % band", zorder=2)
    ax.plot(time, each.predicted[shown], color=PREDICTED, label="from joint torques")
    ax.set_ylabel("vertical force [N]")
    ax.set_title(f"{each.motion}, {each.link.replace('_', ' ')}", loc="right")
    return ax


def stance_page(replay: StanceReplay) -> Page:
    """Make the page of the study: findings, the ground force, and tables.

    Args:
        replay: Replay of the study.

    Returns:
        The page.
    """
    notes = stance_notes(replay)
    caption = "Vertical ground force: force plate, and prediction from joint torques by the estimate without plates"
    pictures = [Picture.of(figure, caption, caption, full=True) for figure in stance_figures(replay).values()]
    parameters = [stance_summary(replay), stance_parameters(replay)]
    sections = [
        Section("Findings", [Text(notes)]),
        Section("Ground force", [*pictures, stance_forces(replay)]),
        Section("Walking", [stance_walk(replay)]),
        Section("Parameters", parameters),
    ]
    summary = [
        "A virtual BLEEX with known parameters swings, squats, stands on one foot and walks. It is identified in three "
        "ways.",
        f"Without force plates the total mass is {_percent(replay.largest('no plates', 'M'))} % off.",
    ]
    return Page(f"BLEEX on the ground (seed {replay.seed})", summary, sections)


def _cells(replay: StanceReplay, way: str, name: str) -> tuple[str, ...]:
    """Value, standard deviation and error of a parameter."""
    estimate = replay.estimates[way]
    if name not in estimate.names:
        return "refused", "", ""
    return _estimate_cells(estimate, name, replay.true_value(way, name))


def _estimate_cells(estimate: Estimate, name: str, true: float) -> tuple[str, ...]:
    value = estimate[name].value
    return *with_error(value, float(estimate.std[estimate.names.index(name)])), f"{100.0 * (value / true - 1.0):+.2f} %"


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{100.0 * share:.2g}"


def _way_json(replay: StanceReplay, way: str) -> dict[str, Any]:
    estimate = replay.estimates[way]
    return {
        "values": _by_name(estimate.names, estimate.values),
        "std": _by_name(estimate.names, estimate.std),
        "interval": {name: estimate.interval(0.95)[k].tolist() for k, name in enumerate(estimate.names)},
        "errors": _by_name(estimate.names, replay.errors(way)),
        "coverage": replay.coverage(way),
        "largest": {s: None if np.isnan(replay.largest(way, s)) else replay.largest(way, s) for s in "MXJ"},
        "refused": replay.refused if way == "swing" else None,
    }


def _by_name(names: Sequence[str], values: FloatArray) -> dict[str, float]:
    return dict(zip(names, values.tolist(), strict=True))


def _force_json(each: ForceError) -> dict[str, Any]:
    return {
        "motion": each.motion,
        "link": each.link,
        "vertical_rms": each.force,
        "of_weight": each.relative,
        "centre_of_pressure_rms": each.pressure,
        "within_band": each.inside,
    }


def _walk_json(walk: WalkReplay) -> dict[str, Any]:
    estimates: Mapping[str, Estimate] = {**walk.estimates, "alone": walk.alone}
    return {
        "estimates": {
            name: {"values": _by_name(each.names, each.values), "std": _by_name(each.names, each.std)}
            for name, each in estimates.items()
        },
        "seconds": dict(walk.seconds),
        "fixed_torso": [_finding_json(finding) for finding in walk.fixed],
        "bias_error": walk.bias_error,
    }


def _disturbed_json(each: Disturbed) -> dict[str, Any]:
    return {
        "moved": each.moved,
        "parameter": each.parameter,
        "share": each.share,
        "findings": [_finding_json(finding) for finding in each.findings],
    }


def _finding_json(finding: Finding) -> dict[str, Any]:
    return {
        "kind": finding.kind,
        "joint": finding.joint,
        "severity": finding.severity,
        "value": float(finding.value),
        "message": finding.message,
    }
