"""One HTML page that needs nothing beside it: what it is made of, and how it becomes text."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import resources
from itertools import groupby
from pathlib import Path
from urllib.parse import quote

import jinja2
from matplotlib import rc_context
from matplotlib.figure import Figure

from exoid._version import __version__
from exoid.files import write_whole
from exoid.tables import DataTable
from exoid.view.style import COLUMN, paper

UNQUOTED = " /:;=,+()!*$@?"
"""Characters that may stand in a data URL within an attribute, beside letters and digits."""


CLOUD_DPI = 130
"""Resolution of clouds of points, which are pixels within the drawing."""


PATH, DIGITS = re.compile(rb' d="[^"]*"'), re.compile(rb"(\.\d\d)\d+")
"""Coordinates of a drawing, and their digits."""


@dataclass(frozen=True)
class Picture:
    """A figure.

    Attributes:
        svg: The drawing.
        alternative: What it shows, for those who do not see it.
        caption: Below it.
    """

    svg: bytes
    alternative: str
    caption: str = ""

    @property
    def source(self) -> str:
        """The drawing as a data URL: quoted, as base64 would make what is mostly text a third longer."""
        return "data:image/svg+xml," + quote(self.svg, safe=UNQUOTED)


@dataclass(frozen=True)
class Words:
    """A paragraph, or several as a list.

    Attributes:
        lines: One makes a paragraph, several make a list.
    """

    lines: Sequence[str]


@dataclass(frozen=True)
class Embedded:
    """Another self-contained page within this one.

    Attributes:
        html: That page.
        title: What it shows.
    """

    html: str
    title: str


Part = Picture | DataTable | Words | Embedded


@dataclass(frozen=True)
class Section:
    """A part of a page under a heading of its own."""

    title: str
    parts: Sequence[Part]

    @property
    def groups(self) -> list[list[Part]]:
        """The parts, neighbours of one kind together: pictures stand side by side."""
        return [list(group) for _, group in groupby(self.parts, key=type)]


@dataclass(frozen=True)
class Page:
    """A page.

    Attributes:
        title: Of the page.
        verdict: What a reader in a hurry takes away.
        sections: The rest.
    """

    title: str
    verdict: Sequence[str]
    sections: Sequence[Section]

    def html(self) -> str:
        """Write the page as HTML that loads nothing from anywhere."""
        environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        template = resources.files(__package__).joinpath("page.html.jinja").read_text(encoding="utf-8")
        return environment.from_string(template).render(page=self, version=__version__, kind=_kind)

    def write(self, path: str | Path) -> None:
        """Write the page, whole or not at all.

        Raises:
            ExoidError: The file cannot be written.
        """
        write_whole(path, [self.html()])


def _kind(part: Part) -> str:
    """Name what a part is, for the template."""
    return type(part).__name__


def picture(
    draw: Callable[[Figure], object], alternative: str, caption: str = "", *, columns: float = 1.0, aspect: float = 0.7
) -> Picture:
    """Draw a figure for a page.

    Args:
        draw: Draws on the figure.
        alternative: What it shows, in words.
        caption: Below it.
        columns: Width in columns of a paper.
        aspect: Height over the width of one column.
    """
    with paper():
        figure = Figure(figsize=(columns * COLUMN, aspect * COLUMN))
        draw(figure)
        return picture_of(figure, alternative, caption)


def picture_of(figure: Figure, alternative: str, caption: str = "") -> Picture:
    """Take a figure that is drawn already."""
    file = io.BytesIO()
    with paper(), rc_context({"svg.hashsalt": "exoid"}):  # the same drawing gives the same bytes
        figure.savefig(file, format="svg", dpi=CLOUD_DPI, metadata={"Date": None})
    return Picture(PATH.sub(_rounded, file.getvalue()), alternative, caption)


def _rounded(path: re.Match[bytes]) -> bytes:
    """Write the numbers of a path to hundredths of a point, which is finer than any screen and half as long."""
    return DIGITS.sub(rb"\1", path[0])
