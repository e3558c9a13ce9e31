"""A self-contained HTML page: its blocks, and how it is rendered."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from itertools import groupby
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
from matplotlib.figure import Figure

from exoid._version import __version__
from exoid.tools.files import write_whole
from exoid.tools.tables import DataTable
from exoid.view.style import COLUMN, PAGE, paper, render

PAGE_COLUMN = 2.9
"""Width of a figure on a page [inches]: narrower than a column of a paper, so that its text is readable on a phone."""

PATH, DIGITS = re.compile(rb' d="[^"]*"'), re.compile(rb"(\.\d\d)\d+")
"""Paths of a drawing, and the digits of their coordinates beyond hundredths."""


@dataclass(frozen=True)
class Picture:
    """A figure on a page, and a panel of a figure of a paper."""

    draw: Callable[[Any], object]  # draws on a figure, or on a part of one
    alt_text: str  # description for readers who do not see the drawing
    caption: str = ""  # text below the drawing
    figure: str = ""  # name of the figure of a paper; "" for none
    width: float = PAGE_COLUMN  # width on a page [inches]
    height: float = 0.7 * PAGE_COLUMN  # height [inches]
    across: int = 3  # largest number of panels side by side in a paper
    full: bool = False  # whether it takes the full width of the page, and scrolls on a phone

    @cached_property
    def svg(self) -> bytes:
        """Drawing as SVG."""
        with paper():
            figure = Figure(figsize=(self.width, self.height))
            self.draw(figure)
        # Resolution of scatter plots, which are bitmaps within the drawing. The page is the background.
        drawing = render(figure, "svg", dpi=130, transparent=True)
        # Hundredths of a point are finer than a screen, and make the file half as long.
        return PATH.sub(lambda path: DIGITS.sub(rb"\1", path[0]), drawing)

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

    def figures(self) -> dict[str, Figure]:
        """Draw the pictures as figures of a paper, by name: pictures of one name are its panels."""
        panels: dict[str, list[Picture]] = {}
        for block in (block for section in self.sections for block in section.blocks):
            if isinstance(block, Picture) and block.figure:
                panels.setdefault(block.figure, []).append(block)
        return {name: paper_figure(each) for name, each in panels.items()}


def on_axes(plot: Callable[..., object], *arguments: object) -> Callable[[Any], object]:
    """Draw on single axes of a figure by ``plot(ax, *arguments)``."""
    return lambda figure: plot(figure.add_subplot(), *arguments)


def paper_figure(panels: Sequence[Picture]) -> Figure:
    """Draw one panel in one column, or several in two, at most three side by side."""
    across = min(len(panels), 2 if len(panels) == 4 else panels[0].across)
    panels = sorted(panels, key=lambda panel: -panel.height)  # so that neighbours have one height
    rows = [panels[k : k + across] for k in range(0, len(panels), across)]
    heights = [max(panel.height for panel in row) for row in rows]
    with paper():
        sheet = Figure(figsize=(PAGE if across > 1 or panels[0].full else COLUMN, sum(heights)))
        cells = sheet.subfigures(len(rows), across, squeeze=False, height_ratios=heights).ravel()
        for cell, panel in zip(cells, panels, strict=False):
            panel.draw(cell)
        legends = [legend for cell in cells for ax in cell.axes if (legend := ax.get_legend())]
        if len(legends) > 1 and len({tuple(text.get_text() for text in each.get_texts()) for each in legends}) == 1:
            handles, labels = legends[0].axes.get_legend_handles_labels()
            for each in legends:
                each.remove()
            sheet.legend(handles, labels, loc="outside upper left", ncols=len(labels))
    return sheet
