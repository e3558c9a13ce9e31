"""What a wearer feels, as tables, as JSON, as figures and as a page."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from exoid.lab.stability import Amplification
from exoid.tools.tables import DataTable, to_text
from exoid.view import paper
from exoid.view.colours import CAD, IDENTIFIED, MEASURED, RESIDUAL
from exoid.view.report import Page, Picture, Section, Text
from exoid.view.style import COLUMN, legend_above

from .report import as_list
from .wear_study import MARGIN, WearStudy

LABELS = {"off": "off", "cad": "CAD", "identified": "identified", "truth": "truth"}
"""Names of the models in tables and figures."""

COLOURS = {"off": RESIDUAL, "cad": CAD, "identified": IDENTIFIED, "truth": MEASURED}
"""Colours of the models."""


def wear_text(study: WearStudy) -> str:
    """Print what limits the amplification, and what is felt.

    Args:
        study: The study.

    Returns:
        Text of several lines.
    """
    return to_text(*as_list(wear_notes(study)), "", wear_table(study))


def wear_table(study: WearStudy) -> DataTable:
    """Make a table of the felt torque, one line a model."""
    rows = []
    for name, felt in study.felt.items():
        largest = study.largest.get(name)
        amplification = "" if felt.amplification is None else f"{felt.amplification:.3g}"
        cells = (f"{x:.3g}" for x in (*felt.rms, felt.rms_of_all))
        rows.append((LABELS[name], "" if largest is None else _largest(largest), amplification, *cells))
    headers = ("controller knows", "largest α", "α used", *study.joint_names, "all")
    title = f"RMS torque between wearer and {study.name} [N·m], stride of {study.period:g} s; largest stable α"
    return DataTable(title, headers, rows)


def wear_notes(study: WearStudy) -> list[str]:
    """Say what the table means."""
    felt = {name: each.rms_of_all for name, each in study.felt.items()}
    notes = [
        f"The identified model leaves {100.0 * felt['identified'] / felt['cad']:.0f} % of what is felt with CAD, and "
        f"{felt['identified'] / felt['truth']:.2f} times what is felt with the true model.",
        f"1/α of inertia and friction alone are {study.floor_of_all:.3g} N·m, without lag, noise and model error: "
        f"{100.0 * study.floor_of_all / felt['cad']:.0f} % of what is felt with CAD.",
        f"α is {MARGIN:g} of the largest stable one, at most {max(_used(study)):.3g}; 95 % of the distribution of the "
        "identified model are stable.",
    ]
    identified = study.largest["identified"]
    if study.limited_by is not None and np.isfinite(identified.largest):
        notes.append(f"What is known of {study.limited_by} limits it most.")
    elif study.limited_by is not None:
        notes.append(f"Nothing limits it up to {identified.most:g}; the next limit would come from {study.limited_by}.")
    return notes


def wear_json(study: WearStudy) -> dict[str, Any]:
    """Convert the study to JSON types.

    Args:
        study: The study.

    Returns:
        Felt torque [N·m], amplifications (at most those tried), and the parameter that limits them.
    """
    return {
        "felt_rms": {name: each.rms_of_all for name, each in study.felt.items()},
        "felt_rms_by_joint": {
            name: dict(zip(study.joint_names, each.rms.tolist(), strict=True)) for name, each in study.felt.items()
        },
        "floor_rms": study.floor_of_all,
        "amplification": {name: each.amplification for name, each in study.felt.items() if name != "off"},
        "largest_amplification": {name: min(each.largest, each.most) for name, each in study.largest.items()},
        "largest_tried": study.largest["identified"].most,
        "limited_by": study.limited_by,
        "period": study.period,
        "seed": study.seed,
    }


def wear_figures(study: WearStudy) -> dict[str, Figure]:
    """Draw the felt torque of each model over the last stride, one axes a joint.

    Args:
        study: The study.

    Returns:
        Figure by file name.
    """
    with paper():
        n = len(study.joint_names)
        figure = Figure(figsize=(2.0 * COLUMN, 0.4 + 1.3 * n))
        axes = figure.subplots(n, 1, sharex=True, squeeze=False)[:, 0]
        for name, felt in study.felt.items():
            run, exact = felt.run, name == "truth"
            assert run.interaction is not None
            last = run.time >= run.time[-1] - study.period
            style: dict[str, Any] = {"color": COLOURS[name], "lw": 2.0 if exact else 1.0, "zorder": 1 if exact else 2}
            label = LABELS[name] if felt.amplification is None else f"{LABELS[name]}, α = {felt.amplification:.3g}"
            for ax, torque in zip(axes, run.interaction[last].T, strict=True):
                ax.plot(run.time[last] - run.time[last][0], torque, label=label, **style)
        for ax, joint in zip(axes, study.joint_names, strict=True):
            ax.set_ylabel(f"{joint} [N·m]")
        legend_above(axes[0], 4)
        axes[-1].set_xlabel("time in the stride [s]")
    return {"felt_torque": figure}


def wear_page(study: WearStudy) -> Page:
    """Make the page of the study: notes, table and figure.

    Args:
        study: The study.

    Returns:
        The page.
    """
    caption = "Torque of the wearer on the leg over one stride"
    pictures = [Picture.of(figure, caption, caption, full=True) for figure in wear_figures(study).values()]
    first, *others = wear_notes(study)
    sections = [Section("Findings", [Text(others)]), Section("Felt torque", [*pictures, wear_table(study)])]
    return Page(f"What the wearer of {study.name} feels (seed {study.seed})", [first], sections)


def _largest(found: Amplification) -> str:
    """Write the largest stable amplification."""
    return f"{found.largest:.3g}" if np.isfinite(found.largest) else f"above {found.most:g}"


def _used(study: WearStudy) -> list[float]:
    return [each.amplification for each in study.felt.values() if each.amplification is not None]
