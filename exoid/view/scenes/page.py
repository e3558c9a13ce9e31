"""One self-contained HTML page: meshcat's viewer, the scene as JSON, a legend, a player and readings."""

from __future__ import annotations

import base64
import html
import json
import re
import zlib
from collections.abc import Mapping
from functools import cache, lru_cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from exoid.errors import NotSupportedError
from exoid.tools.extras import install_extra
from exoid.view.colours import MEASURED, PREDICTED, WEIGHT


def write_page(scene: Mapping[str, Any]) -> str:
    """Render the page of a scene."""
    data = json.dumps(scene, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    pieces = {
        "STYLE": _own_file("page.css"),
        "SCRIPT": "\n".join(map(_own_file, ("readings.js", "page.js"))),
        "TITLE": html.escape(str(scene["title"])),
        "LICENCES": _viewer_file("dist/main.min.js.LICENSE.txt").replace("--", "- -"),
        "VIEWER": _packed(_viewer_file("dist/main.min.js")),
        "SCENE": _packed(data),
    }
    return re.sub(r"@([A-Z]+)@", lambda match: pieces[match[1]], _own_file("page.html"))


@lru_cache(maxsize=4)
def _packed(text: str) -> str:
    """Compress to a third of the size, as base64, which needs no escape; the page unpacks it."""
    return base64.b64encode(zlib.compress(text.encode(), 6)).decode()


@cache
def _own_file(name: str) -> str:
    """Read a file of this package, with the colours of the figures in it."""
    text = files(__package__).joinpath(name).read_text(encoding="utf-8")
    for word, colour in (("MEASURED", MEASURED), ("PREDICTED", PREDICTED), ("WEIGHT", WEIGHT)):
        text = text.replace(f"@{word}@", colour.lower())
    return text


@cache
def _viewer_file(name: str) -> str:
    """Read a file of meshcat's viewer without importing meshcat, which would load ZMQ, Tornado and IPython."""
    for folder in getattr(find_spec("meshcat"), "submodule_search_locations", None) or ():
        path = Path(folder) / "viewer" / name
        if path.is_file():
            return path.read_text(encoding="utf-8")
    raise NotSupportedError("the viewer (meshcat) is not installed", remedy=install_extra("view"))
