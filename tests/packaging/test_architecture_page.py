"""The picture in docs/architecture.md shows the imports of the packages as they are."""

import runpy
import sys
from pathlib import Path

import pytest
from processes import run

ROOT = Path(__file__).resolve().parents[2]
SCRIPT, PAGE = ROOT / "scripts" / "import_graph.py", ROOT / "docs" / "architecture.md"

pytestmark = pytest.mark.skipif(not SCRIPT.is_file(), reason="needs the source tree")


@pytest.fixture(scope="module")
def script():
    pytest.importorskip("grimp", reason="comes with the extra lint")
    return runpy.run_path(str(SCRIPT))


def test_the_picture_is_up_to_date(script):
    rooms = script["rooms"]()
    picture = script["mermaid"](rooms, script["reduced"](script["imports_between"](rooms)))
    assert picture in PAGE.read_text(encoding="utf-8"), "run scripts/import_graph.py"


def test_the_table_names_every_room(script):
    page = PAGE.read_text(encoding="utf-8")
    for number, room in enumerate(script["rooms"](), 1):
        assert f"| {number} | `{room}` |" in page


@pytest.mark.slow
def test_the_route_of_a_recording_is_what_the_script_prints():
    printed = run(sys.executable, ROOT / "scripts" / "route.py", cwd=ROOT)
    assert printed in PAGE.read_text(encoding="utf-8"), "run scripts/route.py"
