"""``exoid wear``: what a wearer feels of a leg, by the model that its controller knows."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from exoid.estimate import Estimate
from exoid.tools.files import make_folder

from .inputs import AsJson, Report
from .messages import note
from .outputs import check_outputs
from .progress import progress_bar


def wear(
    what: Annotated[str, typer.Argument(metavar="bleex|cuhk|EST.JSON", help="A document's leg, or an estimate.")],
    period: Annotated[float | None, typer.Option(metavar="S", help="Period of the stride; default 4.")] = None,
    most: Annotated[float | None, typer.Option(metavar="X", help="Largest amplification; default 10.")] = None,
    bandwidth: Annotated[
        float | None, typer.Option(metavar="HZ", help="Bandwidth of the controller's motion filter; default 50.")
    ] = None,
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Rate of the controller; default 1000.")] = None,
    height: Annotated[float, typer.Option(metavar="M", help="Height of the wearer.")] = 1.75,
    mass: Annotated[float, typer.Option(metavar="KG", help="Mass of the wearer.")] = 70.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of noise and draws.")] = 0,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Folder for the figure.")] = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Let a wearer walk in a leg: what is felt with the leg off, and with CAD, identified and true model.

    The controller is sensitivity amplification, with the largest stable amplification of each model. For bleex and cuhk
    the virtual rig of the document's replay is worn. For an estimate the rig is drawn from its distribution.

    Example: exoid wear est.json --period 2.5
    """
    from exoid.lab import reproduce  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    if figures is not None:
        make_folder(figures)  # before the minute that the study takes
    check_outputs({"--report": report}, [what])
    source = what if what in ("bleex", "cuhk") else Estimate.load(what)
    given = {"period": period, "most": most, "bandwidth": bandwidth, "rate": rate}
    options: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    with progress_bar("walking") as progress:
        study = reproduce.wear(source, height=height, mass=mass, seed=seed, progress=progress, **options)
    if figures is not None:
        for path in write_figures(figures, reproduce.wear_figures(study)):
            note(f"wrote {path}")
    if report is not None:
        reproduce.wear_page(study).save(report)
        note(f"wrote {report}")
    typer.echo(json.dumps(reproduce.wear_json(study), indent=1) if as_json else reproduce.wear_text(study))
