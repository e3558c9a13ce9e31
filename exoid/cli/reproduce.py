"""``exoid reproduce``: a document replayed on the virtual rig, or the study of stance beside both."""

from __future__ import annotations

from typing import Annotated, Literal

from typer import Argument, Option

from .messages import progress_bar
from .options import AsJson, Figures, Report
from .outputs import check_outputs, show_report


def reproduce(
    document: Annotated[
        Literal["bleex", "cuhk", "tracking", "stance"], Argument(help="Exoskeleton of the document, or a study.")
    ],
    seed: Annotated[int, Option(min=0, metavar="N", help="Seed of random poses and sensor noise.")] = 0,
    figures: Figures = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run a document's experiments on virtual rigs, identify, and print every table side by side.

    "tracking" is document 2's comparison of controllers, on a leg identified from noisy data. "stance" is a study
    beside the documents: BLEEX swings, stands and walks, with and without force plates.

    Example: exoid reproduce cuhk --report cuhk.html
    """
    from exoid.lab import reproduce as replays  # noqa: PLC0415 - matplotlib would slow down the help

    check_outputs({"--report": report}, folder=figures)
    with progress_bar(f"replaying {document}") as progress:
        if document == "bleex":
            found = replays.bleex_report(replays.reproduce_bleex(seed, progress=progress)[0])
        elif document == "cuhk":
            found = replays.cuhk_report(replays.reproduce_cuhk(seed, progress=progress)[0])
        elif document == "tracking":
            from exoid.lab.reproduce.tracking_report import cuhk_tracking_report  # noqa: PLC0415 - see above

            found = cuhk_tracking_report(replays.reproduce_cuhk_tracking(seed, progress=progress))
        else:
            found = replays.stance_report(replays.reproduce_stance(seed, progress=progress))
    show_report(found, figures, report, as_json=as_json)
