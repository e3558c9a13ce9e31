"""A row of each sample of a recording, as predictions and pictures of it need."""

from __future__ import annotations

from collections.abc import Iterator

from exoid.signals import Poses, Preparation, Recording

from .model import RegressorModel
from .row_data import Rows
from .rows import Prepared, chain, form_rows, prepare


def make_rows(model: RegressorModel, data: Recording | Poses, preparation: Preparation) -> Rows:
    """Make a row of each sample of a recording that counts, or of poses, all at once; see :func:`each_row`."""
    return chain(list(each_row(model, prepare(model, data, preparation, every=True))))


def each_row(model: RegressorModel, prepared: Prepared) -> Iterator[Rows]:
    """Make a row of each sample of a recording that counts, or of poses, stretch by stretch."""
    # Towards the ends of a segment, both sides of τ = W β fade behind the filter, as it sees zeros beyond. Here
    # they are divided by what the filter makes of ones in all segments. Rows are then weighted means of the
    # torques around them, as one wants to see them, but those near the ends have more noise than others.
    for stretch in prepared.stretches():
        rows = form_rows(model, prepared, stretch)
        counted = prepared.inside[stretch.start : stretch.stop]
        if prepared.parallel is not None:
            gain = prepared.parallel.gain(prepared.inside, stretch)
            known = None if rows.known is None else rows.known / gain[:, None]
            rows = rows._replace(W=rows.W / gain[:, None, None], tau=rows.tau / gain[:, None], known=known)
        if not counted.all():
            rows = rows._replace(**{name: x[counted] for name, x in rows.of_samples.items()})
        yield rows
