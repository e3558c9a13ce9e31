"""``exoid wear``: what a wearer feels of a leg, by the model that its controller knows."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from .inputs import load_estimate
from .messages import progress_bar
from .numbers import parse_roles
from .options import AsJson, Figures, Report, Roles
from .outputs import check_outputs, show_report


def wear(
    what: Annotated[str, Argument(metavar="bleex|cuhk|EST.JSON", help="A document's leg, or an estimate.")],
    period: Annotated[float, Option(metavar="S", help="Period of the stride.")] = 4.0,
    bandwidth: Annotated[float, Option(metavar="HZ", help="Bandwidth of the controller's motion filter.")] = 50.0,
    rate: Annotated[float, Option(metavar="HZ", help="Rate of the controller.")] = 1000.0,
    role: Roles = None,
    seed: Annotated[int, Option(min=0, metavar="N", help="Seed of noise and draws.")] = 0,
    figures: Figures = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Let a wearer walk in a leg: what is felt with the leg off, and with CAD, identified and true model.

    The controller is sensitivity amplification, with the largest stable amplification of each model. For bleex and cuhk
    the virtual rig of the document's replay is worn. For an estimate the rig is drawn from its distribution.

    Example: exoid wear est.json --period 2.5
    """
    from exoid.lab import reproduce  # noqa: PLC0415 - matplotlib would slow down the help

    check_outputs({"--report": report}, [what], figures)
    source = what if what in ("bleex", "cuhk") else load_estimate(what)
    with progress_bar("walking") as progress:
        study = reproduce.wear(
            source, period=period, bandwidth=bandwidth, rate=rate, roles=parse_roles(role), seed=seed, progress=progress
        )
    show_report(reproduce.wear_report(study), figures, report, as_json=as_json)
