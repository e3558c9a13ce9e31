"""Report of a comparison of control laws: tables, figures, and what document 2 says of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.control import LawReplay, Tracking
from exoid.control.tracking import tracking_table
from exoid.tools.json_values import json_value
from exoid.tools.tables import DataTable
from exoid.torques.position_units import heading
from exoid.view import plot_law_torques, plot_peak_errors, plot_tracking_errors
from exoid.view.colours import LAW_COLOURS
from exoid.view.style import COLUMN, paper
from exoid.view.tracking import plot_law_replay

from .cuhk_tracking import GAINS, TrackingReplay
from .report import Drawing, ReplayReport

LABELS = {
    "pd_30hz": "PD, 30 Hz",
    "pd": "PD",
    "gravity_friction_pd": "PD + G + F",
    "feedforward_pd": "PD + feed-forward",
    "computed_torque": "computed torque",
    "lqr": "LQR",
    "self_tuning": "self-tuning",
}
"""Labels of the laws in figures."""

WIDTH = 1.1
"""Width of a figure in columns: its text is readable on a phone."""


def tracking_report(
    title: str,
    runs: Mapping[str, Tracking],
    tables: Sequence[DataTable],
    data: dict[str, Any],
    notes: Sequence[str] = (),
    *,
    of_document: bool = False,
) -> ReplayReport:
    """Report runs by the names of `exoid.control.standard_laws`, and "pd_30hz"."""
    best = min(runs.values(), key=lambda run: float(run.peak_deg.max()))
    peaks = ", ".join(f"{peak:.2f}{unit.name}" for peak, unit in zip(best.peak_deg, best.units, strict=True))
    first = f"The smallest tracking error is that of {best.law}: at most {peaks}."
    return ReplayReport(title, "", [[first, *notes]], tables, data, _drawings(runs, of_document=of_document))


def cuhk_tracking_report(replay: TrackingReplay) -> ReplayReport:
    """Report all laws beside each other and beside document 2."""
    caption = (
        f"CUHK-EXO with payload, rotors of {replay.rotor:g} kg·m², gait of 10 s, gains {GAINS['kp']} N·m/rad and "
        f"{GAINS['kd']} N·m·s/rad; laws know an estimate from noisy data"
    )
    slow, pd, compensated = (replay.laws[name] for name in ("pd_30hz", "pd", "gravity_friction_pd"))
    by_rate, by_law = abs(slow.peak_deg - pd.peak_deg), pd.peak_deg - compensated.peak_deg
    notes = [
        f"Document 2 reports peak errors [deg]: {LABELS['pd']} 15 / 12; {LABELS['gravity_friction_pd']} 10 / 5.",
        f"PD's peak errors change by {_pair(by_rate, '.2f')}° from 30 to 100 Hz; G + F lower them by "
        f"{_pair(by_law, '.1f')}°.",
        f"PD + G + F takes {_pair(compensated.rms_torque / pd.rms_torque, '.1f')} times the rms torque of PD and "
        f"{_pair(compensated.energy / pd.energy, '.1f')} times its energy; document 2 calls their power comparable.",
    ]
    tables = [tracking_table(caption, replay.laws.values())]
    data = laws_json(replay.laws, GAINS["kp"], GAINS["kd"], replay.seed)
    return tracking_report("Controllers on cuhk", replay.laws, tables, data, notes, of_document=True)


def laws_json(runs: Mapping[str, Tracking], kp: Iterable[float], kd: Iterable[float], seed: int) -> dict[str, Any]:
    """Convert a comparison of laws to JSON types: metrics by name of the law, units, gains and seed."""
    laws = {name: run.to_json() for name, run in runs.items()}
    first = next(iter(runs.values()))
    units = {"joint_names": list(first.joint_names), "torque_units": [unit.torque for unit in first.units]}
    units["error_units"] = [heading([unit]) for unit in first.units]  # of peak_deg and rms_deg
    return {"laws": laws, **units, "gains": {"kp": json_value(kp), "kd": json_value(kd)}, "seed": seed}


def law_replay_figure(replay: LawReplay) -> Figure:
    """Draw the torque that a law would have commanded during a log."""
    count = len(replay.joint_names)
    with paper():
        figure = Figure(figsize=(COLUMN, 0.55 * (count + 0.3) * COLUMN))
        plot_law_replay(list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]), replay)
    return figure


def _drawings(runs: Mapping[str, Tracking], *, of_document: bool) -> dict[str, Drawing]:
    """PD and PD with compensation as in figures 8 and 9 of document 2, and all laws at the same rate and gains."""
    joints = [name.removeprefix("left_").removeprefix("right_") for name in next(iter(runs.values())).joint_names]
    slow = "pd_30hz" if "pd_30hz" in runs else "pd"
    pair = {LABELS[name]: runs[name] for name in (slow, "gravity_friction_pd")}
    errors, torques = ("doc2_fig8_errors", "doc2_fig9_torques") if of_document else ("pd_errors", "pd_torques")
    numbers = ("Fig. 8: tracking", "Fig. 9: torques") if of_document else ("Tracking", "Torques")
    every = {LABELS.get(name, name): run for name, run in runs.items() if name != "pd_30hz"}
    colours = dict(zip(every, LAW_COLOURS, strict=False))
    close = {label: run for label, run in every.items() if run.peak_deg.max() < 3.0}

    def each_joint(caption: str, plot: Callable[..., object], shown: Mapping[str, Tracking]) -> Drawing:
        """Draw one axes a joint."""
        own = [colours[label] for label in shown] if shown is close else LAW_COLOURS

        def draw(figure: Figure) -> None:
            axes = figure.subplots(len(joints), 1, sharex=True, squeeze=False)[:, 0]
            plot(axes, shown, names=joints, colours=own)

        return Drawing(caption, draw, 0.55 * (len(joints) + 0.3), WIDTH)

    def draw_peaks(figure: Figure) -> None:
        plot_peak_errors(figure.add_subplot(), every, names=joints)

    with_errors = partial(each_joint, plot=plot_tracking_errors)
    with_torques = partial(each_joint, plot=plot_law_torques)
    drawings = {
        errors: with_errors(f"{numbers[0]} errors under PD and with compensation", shown=pair),
        torques: with_torques(f"{numbers[1]} under PD and with compensation", shown=pair),
        "laws_errors": with_errors("Tracking errors of every law at the same rate and gains", shown=every),
        "laws_torques": with_torques("Torques of every law", shown=every),
        "laws_peak_errors": Drawing("Peak errors", draw_peaks, 0.25 + 0.034 * len(every) * len(joints), WIDTH),
    }
    if 0 < len(close) < len(every):
        caption = "Tracking errors of the most accurate laws, on a finer scale"
        drawings["laws_errors_close"] = with_errors(caption, shown=close)
    return drawings


def _pair(values: FloatArray, form: str) -> str:
    return " / ".join(format(x, form) for x in values)
