"""``exoid coordinate``: contacts and functions of a machine over a day."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from .inputs import load_estimate
from .messages import progress_bar
from .options import AsJson, Figures, Report
from .outputs import check_outputs, show_report


def coordinate(
    leg: Annotated[str, Argument(metavar="bleex|cuhk|EST.JSON", help="A machine, or its estimate on a floating base.")],
    seconds: Annotated[float, Option(metavar="S", help="Duration of the day.")] = 180.0,
    events: Annotated[int, Option(min=0, max=1000, metavar="N", help="Number of planted faults.")] = 40,
    seed: Annotated[int, Option(min=0, metavar="N", help="Seed of motions, noise and faults.")] = 0,
    figures: Figures = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run a day on the rig with ground: sit, rise, walk, stairs, sit; tell contacts by the identified model.

    A servo in a harness tracks the functions. The table has the share of right contacts, and how late they are told.

    Example: exoid coordinate bleex --seconds 60
    """
    from exoid.lab import coordination  # noqa: PLC0415 - matplotlib would slow down the help

    check_outputs({"--report": report}, [] if leg in ("bleex", "cuhk") else [leg], figures)
    source = leg if leg in ("bleex", "cuhk") else load_estimate(leg)
    with progress_bar("running the day") as progress:
        study = coordination.coordinate(source, seconds=seconds, events=events, seed=seed, progress=progress)
    show_report(coordination.coordination_report(study), figures, report, as_json=as_json)
