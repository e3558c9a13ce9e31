"""Replays as HTML pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from exoid.control import Tracking
from exoid.tools.tables import DataTable
from exoid.view.report import Page, Picture, Section, Text

from .bleex import BleexReplay
from .cuhk import CuhkReplay
from .figures import bleex_figures, cuhk_figures
from .report import (
    bleex_errors,
    bleex_notes,
    bleex_parameters,
    bleex_summary,
    cuhk_errors,
    cuhk_notes,
    cuhk_parameters,
    cuhk_summary,
)
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
    "pd_errors": "Tracking errors under PD and with compensation",
    "pd_torques": "Torques under PD and with compensation",
    "laws_errors": "Tracking errors of every law at the same rate and gains",
    "laws_errors_close": "Tracking errors of the most accurate laws, on a finer scale",
    "laws_torques": "Torques of every law",
    "laws_peak_errors": "Largest tracking error of every law",
}
"""Captions of the figures by name."""


def bleex_page(replay: BleexReplay) -> Page:
    """Make the page of a replay of document 1: findings, figures of the left leg, and tables.

    Args:
        replay: Replay of document 1.

    Returns:
        The page.
    """
    sides = (("Left", replay.left), ("Right", replay.right))
    findings = [Section(f"Findings, {name.lower()} leg", [Text(bleex_notes(side))]) for name, side in sides]
    tables = [
        Section(f"Tables of the {name.lower()} leg", [bleex_errors(side), bleex_parameters(name, side)])
        for name, side in sides
    ]
    summary = [
        "The experiments of document 1 on a virtual rig with known parameters, identified by its procedure and by one "
        "joint estimate.",
        bleex_summary(replay.left),
    ]
    figures = Section("Figures of document 1, left leg", _pictures(bleex_figures(replay.left)))
    return Page(f"BLEEX, document 1 replayed (seed {replay.seed})", summary, [*findings, figures, *tables])


def cuhk_page(replay: CuhkReplay) -> Page:
    """Make the page of a replay of document 2: findings, figures and tables.

    Args:
        replay: Replay of document 2.

    Returns:
        The page.
    """
    summary = [
        "The experiments of document 2 and a faster motion on a virtual rig with known parameters.",
        cuhk_summary(replay),
    ]
    sections = [
        Section("Findings", [Text(cuhk_notes(replay))]),
        Section("Figures of document 2", _pictures(cuhk_figures(replay))),
        Section("Tables", [cuhk_errors(replay), cuhk_parameters(replay)]),
    ]
    return Page(f"CUHK-EXO, document 2 replayed (seed {replay.seed})", summary, sections)


def tracking_page(
    title: str, table: DataTable, notes: Sequence[str], runs: Mapping[str, Tracking], *, of_document: bool = False
) -> Page:
    """Make the page of a comparison of control laws.

    Args:
        title: Title of the page.
        table: Table of all laws.
        notes: Notes on the table; may be empty.
        runs: Runs by name of the law.
        of_document: Whether the runs replay document 2.

    Returns:
        The page.
    """
    sections = [
        *([Section("Findings", [Text(notes)])] if notes else []),
        Section("Figures", _pictures(tracking_figures(runs, of_document=of_document))),
        Section("Laws side by side", [table]),
    ]
    best = min(runs.values(), key=lambda run: float(run.peak_deg.max()))
    peaks = ", ".join(f"{peak:.2f}°" for peak in best.peak_deg)
    return Page(title, [f"The smallest tracking error is that of {best.law}: at most {peaks}."], sections)


def _pictures(figures: Mapping[str, Figure]) -> list[Picture]:
    return [Picture.of(figure, CAPTIONS[name], CAPTIONS[name]) for name, figure in figures.items()]
