"""Write docs/images/scene-bleex.png: both BLEEX legs in mid-stride, their CAD and their identified inertias together.

Needs Chromium and the test extra.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import exoid
from exoid.view import scene

ROOT = Path(__file__).parents[1]
STRIDE_DEG = {"left_hip": 32, "left_knee": -48, "left_ankle": 4, "right_hip": -10, "right_knee": -22, "right_ankle": 6}


def main() -> None:
    """Draw the scene, look at it, and write what was seen."""
    sys.path.insert(0, str(ROOT / "tests"))
    from browser import chromium  # noqa: PLC0415 - the tests' browser

    drawn = scene(
        *(exoid.load_leg("bleex", side) for side in ("left", "right")),
        pose={joint: np.deg2rad(angle) for joint, angle in STRIDE_DEG.items()},
        identified=[exoid.load_leg("bleex", side, "identified") for side in ("left", "right")],
        title="BLEEX, Table V and Tables II-III",
    )
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        page_file = Path(folder) / "scene.html"
        drawn.save(page_file)
        with browser.page(page_file.as_uri(), (1000, 800)) as page:
            page.wait_for("window.exoid !== undefined")
            page.evaluate("document.querySelector('.dg.main').style.display = 'none'")
            picture = Image.fromarray(page.screenshot())
    target = ROOT / "docs" / "images" / "scene-bleex.png"
    target.parent.mkdir(exist_ok=True)
    picture.save(target, optimize=True)
    print(f"{target.relative_to(ROOT)}: {target.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
