"""Comparisons of control laws as tables, as JSON and as figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.control import LawReplay, Tracking
from exoid.control.tracking import tracking_table
from exoid.tools.tables import DataTable, to_text
from exoid.view import paper, plot_law_replay, plot_law_torques, plot_peak_errors, plot_tracking_errors
from exoid.view.colours import LAW_COLOURS
from exoid.view.style import COLUMN

from .cuhk_tracking import DOCUMENT_DEG, GAINS, LOADED, PRINTED, TrackingReplay
from .report import as_list

LABELS = {
    "pd_30hz": "PD, 30 Hz",
    "pd": "PD",
    "pd_gravity_friction": "PD + G + F",
    "pd_feedforward": "PD + feed-forward",
    "computed_torque": "computed torque",
    "lqr": "LQR",
    "adaptive": "adaptive",
    "self_tuning": "self-tuning",
}
"""Labels of the laws in figures."""

WIDTH = 1.1 * COLUMN
"""Width of a figure [inches]: its text is readable on a phone."""

CLOSE = 3.0
"""Peak error below which laws are also drawn in a separate figure [deg]."""


def cuhk_tracking_text(replay: TrackingReplay) -> str:
    """Print a comparison of all laws with each other and with document 2.

    Args:
        replay: Replay of document 2's comparison.

    Returns:
        Text of several lines.
    """
    findings = [*cuhk_tracking_notes(replay), *([_table_iii(replay)] if replay.wrong else [])]
    tables = [cuhk_tracking_table(replay), *([wrong_table(replay)] if replay.wrong else [])]
    return to_text(*as_list(findings), "", *tables)


def cuhk_tracking_table(replay: TrackingReplay) -> DataTable:
    """Make a table of all laws.

    Args:
        replay: Replay of document 2's comparison.

    Returns:
        Table with one line a law and joint.
    """
    title = (
        f"CUHK-EXO with payload, rotors of {replay.rotor:g} kg·m², gait of 10 s, gains {GAINS['kp']} N·m/rad and "
        f"{GAINS['kd']} N·m·s/rad; laws know an estimate from noisy data"
    )
    return tracking_table(title, replay.laws.values())


def wrong_table(replay: TrackingReplay) -> DataTable:
    """Make a table of the laws with a wrong model of the leg."""
    return tracking_table("The same with a wrong model of the leg", replay.wrong.values())


def laws_json(runs: Mapping[str, Tracking], kp: Iterable[float], kd: Iterable[float], seed: int) -> dict[str, Any]:
    """Convert a comparison of laws to JSON types.

    Args:
        runs: Runs by name of the law.
        kp: Gains of the joints [N·m/rad].
        kd: Gains of the joints [N·m·s/rad].
        seed: Seed of the sensor noise.

    Returns:
        Tracking errors and torques of each law by name, with gains and seed.
    """
    laws = {name: run.to_json() for name, run in runs.items()}
    return {"laws": laws, "gains": {"kp": [float(k) for k in kp], "kd": [float(k) for k in kd]}, "seed": seed}


def cuhk_tracking_json(replay: TrackingReplay) -> dict[str, Any]:
    """Convert a replay of document 2's comparison to JSON types.

    Args:
        replay: Replay of document 2's comparison.

    Returns:
        Tracking errors and torques of each law by name; those of wrong models under "wrong", if requested.
    """
    data = laws_json(replay.laws, GAINS["kp"], GAINS["kd"], replay.seed)
    if replay.wrong:
        data["wrong"] = {name: run.to_json() for name, run in replay.wrong.items()}
    return data


def tracking_figures(runs: Mapping[str, Tracking], *, of_document: bool = False) -> dict[str, Figure]:
    """Draw errors and torques of PD and of PD with compensation, and of all laws at the same rate and gains.

    The first two figures compare PD, at 30 Hz if it is among the runs, with PD and compensation, as figures 8 and 9
    of document 2 do.

    Args:
        runs: Runs by the names of :func:`exoid.control.standard_laws`, and "pd_30hz".
        of_document: Whether the runs replay document 2, so that its numbers of the figures are in the names.

    Returns:
        Figures by name.
    """
    slow = "pd_30hz" if "pd_30hz" in runs else "pd"
    pair = {LABELS[name]: runs[name] for name in (slow, "pd_gravity_friction")}
    errors, torques = ("doc2_fig8_errors", "doc2_fig9_torques") if of_document else ("pd_errors", "pd_torques")
    every = {LABELS.get(name, name): run for name, run in runs.items() if name != "pd_30hz"}
    colours = dict(zip(every, LAW_COLOURS, strict=False))
    close = {label: run for label, run in every.items() if run.peak_deg.max() < CLOSE}
    with paper():
        figures = {
            errors: _figure(plot_tracking_errors, pair),
            torques: _figure(plot_law_torques, pair),
            "laws_errors": _figure(plot_tracking_errors, every),
            "laws_torques": _figure(plot_law_torques, every),
            "laws_peak_errors": _peaks(every),
        }
        if 0 < len(close) < len(every):
            figures["laws_errors_close"] = _figure(plot_tracking_errors, close, [colours[label] for label in close])
    return figures


def cuhk_tracking_notes(replay: TrackingReplay) -> Sequence[str]:
    """Compare the results with those that document 2 reports.

    Args:
        replay: Replay of document 2's comparison.

    Returns:
        Sentences.
    """
    laws = replay.laws
    slow, pd, compensated = (laws[name] for name in ("pd_30hz", "pd", "pd_gravity_friction"))
    printed = "; ".join(f"{LABELS[name]} {hip:g} / {knee:g}" for name, (hip, knee) in DOCUMENT_DEG.items())
    by_rate, by_law = abs(slow.peak_deg - pd.peak_deg), pd.peak_deg - compensated.peak_deg
    return [
        f"Document 2 reports peak errors [deg]: {printed}.",
        f"PD's peak errors change by {_pair(by_rate, '.2f')}° from 30 to 100 Hz; G + F lower them by "
        f"{_pair(by_law, '.1f')}°.",
        f"PD + G + F takes {_pair(compensated.rms_torque / pd.rms_torque, '.1f')} times the rms torque of PD and "
        f"{_pair(compensated.energy / pd.energy, '.1f')} times its energy; document 2 calls their power comparable.",
    ]


def _table_iii(replay: TrackingReplay) -> str:
    printed, pd = replay.wrong[f"pd_gravity_friction {PRINTED}"], replay.laws["pd"]
    return (
        f"Compensating with Table III as printed errs by {_pair(printed.peak_deg, '.0f')}°, PD alone by "
        f"{_pair(pd.peak_deg, '.0f')}°. {LOADED}: on the shank of the rig."
    )


def _pair(values: FloatArray, form: str) -> str:
    return " / ".join(format(x, form) for x in values)


def _figure(
    plot: Any,  # noqa: ANN401 - a function of the view
    runs: Mapping[str, Tracking],
    colours: Sequence[str] = LAW_COLOURS,
) -> Figure:
    labels = _labels(runs)
    figure = Figure(figsize=(WIDTH, 0.55 * COLUMN * (len(labels) + 0.3)))
    plot(figure.subplots(len(labels), 1, sharex=True, squeeze=False)[:, 0], runs, names=labels, colours=colours)
    return figure


def law_replay_figure(replay: LawReplay) -> Figure:
    """Draw the torque that a law would have commanded during a log."""
    count = len(replay.joint_names)
    with paper():
        figure = Figure(figsize=(WIDTH, 0.55 * COLUMN * (count + 0.3)))
        plot_law_replay(list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]), replay)
    return figure


def _peaks(runs: Mapping[str, Tracking]) -> Figure:
    figure = Figure(figsize=(WIDTH, 0.8 * COLUMN))
    plot_peak_errors(figure.add_subplot(), runs, names=_labels(runs))
    return figure


def _labels(runs: Mapping[str, Tracking]) -> list[str]:
    names = next(iter(runs.values())).joint_names
    return [name.removeprefix("left_").removeprefix("right_") for name in names]
