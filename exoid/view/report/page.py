"""A self-contained HTML page: its blocks, and how it is rendered."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from itertools import groupby
from pathlib import Path
from urllib.parse import quote

import jinja2
from matplotlib import rc_context
from matplotlib.figure import Figure

from exoid._version import __version__
from exoid.tools.files import write_whole
from exoid.tools.tables import DataTable
from exoid.view.style import paper

PAGE_COLUMN = 2.9
"""Width of a figure on a page [inches]: narrower than a column of a paper, so that its text is readable on a phone."""

PATH, DIGITS = re.compile(rb' d="[^"]*"'), re.compile(rb"(\.\d\d)\d+")
"""Paths of a drawing, and the digits of their coordinates beyond hundredths."""


@dataclass(frozen=True)
class Picture:
    """A figure on a page."""

    svg: bytes  # drawing as SVG
    alt_text: str  # description for readers who do not see the drawing
    caption: str = ""  # text below the drawing
    full: bool = False  # whether it takes the full width of the page, and scrolls on a phone

    @classmethod
    def of(cls, figure: Figure, alt_text: str, caption: str = "", *, full: bool = False) -> Picture:
        """Render a figure."""
        file = io.BytesIO()
        with paper(), rc_context({"svg.hashsalt": "exoid"}):
            # Resolution of scatter plots, which are bitmaps within the drawing.
            figure.savefig(file, format="svg", dpi=130, metadata={"Date": None})
        return cls(PATH.sub(_rounded, file.getvalue()), alt_text, caption, full)

    @property
    def data_url(self) -> str:
        """Drawing as a data URL. It is quoted: base64 makes text a third longer."""
        # Characters, besides letters and digits, that a data URL within an attribute may contain unquoted.
        return "data:image/svg+xml," + quote(self.svg, safe=" /:;=,+()!*$@?")


@dataclass(frozen=True)
class Text:
    """A paragraph or a list."""

    lines: Sequence[str]  # one line makes a paragraph, several make a list


@dataclass(frozen=True)
class EmbeddedPage:
    """A self-contained page inside another page."""

    html: str  # text of the page
    title: str  # title of its frame


Block = Picture | DataTable | Text | EmbeddedPage


@dataclass(frozen=True)
class Section:
    """A heading and the blocks below it."""

    title: str  # heading
    blocks: Sequence[Block]  # content, from top to bottom

    @property
    def groups(self) -> list[list[Block]]:
        """Blocks, grouped with neighbours of the same kind: pictures stand side by side."""
        return [list(group) for _, group in groupby(self.blocks, key=type)]


@dataclass(frozen=True)
class Page:
    """A page."""

    title: str  # title and first heading
    summary: Sequence[str]  # main results, one paragraph each
    sections: Sequence[Section]  # sections below the summary

    @classmethod
    def of(cls, title: str, summary: Sequence[str], contents: Mapping[str, Iterable[Block]]) -> Page:
        """Make a page of the blocks below each heading; headings without any are left out."""
        sections = [Section(heading, blocks) for heading, each in contents.items() if (blocks := list(each))]
        return cls(title, summary, sections)

    def html(self) -> str:
        """Render the page as HTML."""
        environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        template = resources.files(__package__).joinpath("page.html.jinja").read_text(encoding="utf-8")
        return environment.from_string(template).render(
            page=self, version=__version__, kind=lambda block: type(block).__name__
        )

    def save(self, path: str | Path) -> None:
        """Write the page to a file, whole or not at all."""
        write_whole(path, [self.html()])


def draw_picture(
    draw: Callable[[Figure], object],
    alt_text: str,
    caption: str = "",
    *,
    columns: float = 1.0,
    aspect: float = 0.7,
    full: bool = False,
) -> Picture:
    """Draw a figure for a page."""
    with paper():
        figure = Figure(figsize=(columns * PAGE_COLUMN, aspect * PAGE_COLUMN))
        draw(figure)
        return Picture.of(figure, alt_text, caption, full=full)


def plot_picture(
    plot: Callable[..., object], arguments: Sequence[object], alt_text: str, caption: str = "", *, aspect: float = 0.7
) -> Picture:
    """Draw a picture of single axes by ``plot(ax, *arguments)``."""
    return draw_picture(lambda figure: plot(figure.add_subplot(), *arguments), alt_text, caption, aspect=aspect)


def _rounded(path: re.Match[bytes]) -> bytes:
    """Cut the coordinates of a path to hundredths of a point: finer than a screen, half as long."""
    return DIGITS.sub(rb"\1", path[0])
