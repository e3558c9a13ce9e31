"""Replays as HTML pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.control import Tracking
from exoid.tables import DataTable
from exoid.view.report import Page, Picture, Section, Text

from .bleex import BleexReplay
from .cuhk import CuhkReplay
from .figures import bleex_figures, cuhk_figures
from .report import bleex_errors, bleex_notes, bleex_parameters, cuhk_errors, cuhk_notes, cuhk_parameters
from .tracking_report import tracking_figures

CAPTIONS = {
    "doc1_fig3_static_friction": "Fig. 3: torque that holds the ankle, reached from below and from above",
    "doc1_fig4_stiffness": "Fig. 4: ankle torque over ankle angle where gravity is the same",
    "doc1_fig5_inertia": "Fig. 5: ankle torque in proportion to the knee's acceleration",
    "doc1_fig6_kinetic_friction": "Fig. 6: ankle friction over velocity",
    "doc1_fig7_validation": "Fig. 7: measured and predicted torque of the validation motion",
    "doc2_fig3_validation": "Fig. 3: measured and predicted torque of the validation motion",
    "doc2_fig6_reference": "Fig. 6: hip and knee angles of a stride",
    "doc2_fig8_errors": "Fig. 8: tracking errors under PD and with compensation",
    "doc2_fig9_torques": "Fig. 9: torques under PD and with compensation",
    "laws_errors": "Tracking errors of every law at the same rate and gains",
    "laws_errors_close": "Those of the laws that err little, in which they can be told apart",
    "laws_torques": "Torques of every law",
    "laws_peak_errors": "Largest tracking error of every law",
}
"""Of figures by name."""


def bleex_page(replay: BleexReplay) -> Page:
    """Document 1 replayed: every table of both legs, the figures of the left one, and what they mean."""
    sections = [
        Section(f"{name} leg", [bleex_parameters(name, side), bleex_errors(side), Text(bleex_notes(side))])
        for name, side in (("Left", replay.left), ("Right", replay.right))
    ]
    left, joint = replay.left.nrmse["sequential"], replay.left.nrmse["joint"]
    verdict = [
        "Document 1's experiments, run on a virtual rig whose parameters are known, identified in its way and in one "
        "joint estimate.",
        f"On a motion that neither has seen, the left leg's torque error falls from {_percent(left)} % to "
        f"{_percent(joint)} % (hip, knee, ankle).",
    ]
    figures = Section("Figures of document 1, left leg", _pictures(bleex_figures(replay.left)))
    return Page(f"BLEEX, document 1 replayed (seed {replay.seed})", verdict, [*sections, figures])


def cuhk_page(replay: CuhkReplay) -> Page:
    """Document 2 replayed: its tables, its figures, and what they mean."""
    notes = cuhk_notes(replay)
    verdict = [
        "Document 2's experiments, run on a virtual rig whose parameters are known, and a faster motion beside them.",
        notes[0],
    ]
    sections = [
        Section("Parameters", [cuhk_parameters(replay), cuhk_errors(replay), Text(notes)]),
        Section("Figures of document 2", _pictures(cuhk_figures(replay))),
    ]
    return Page(f"CUHK-EXO, document 2 replayed (seed {replay.seed})", verdict, sections)


def tracking_page(title: str, table: DataTable, notes: Sequence[str], runs: Mapping[str, Tracking]) -> Page:
    """Control laws side by side.

    Args:
        title: Of the page.
        table: Of all laws.
        notes: What the table means.
        runs: By name of the law.
    """
    sections = [
        Section("Laws side by side", [table, *([Text(notes)] if notes else [])]),
        Section("Figures", _pictures(tracking_figures(runs))),
    ]
    best = min(runs.values(), key=lambda run: float(run.peak_deg.max()))
    peaks = ", ".join(f"{peak:.2f}°" for peak in best.peak_deg)
    return Page(title, [f"The smallest tracking error is that of {best.law}: at most {peaks}."], sections)


def _pictures(figures: Mapping[str, Figure]) -> list[Picture]:
    return [Picture.of(figure, CAPTIONS[name], CAPTIONS[name]) for name, figure in figures.items()]


def _percent(errors: FloatArray) -> str:
    return "/".join(f"{100.0 * error:.1f}" for error in errors)
