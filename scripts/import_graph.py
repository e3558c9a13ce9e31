"""Draw the imports between exoid's packages, and count their lines, for docs/architecture.md.

    python scripts/import_graph.py            # rewrites the two generated parts of the page
    python scripts/import_graph.py --print    # prints them only

Needs grimp, which import-linter brings (``pip install -e '.[lint]'``). The rooms are those of the import contract in
pyproject.toml.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import grimp

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"
PACKAGE = "exoid"

NOT_DRAWN = "_typing"
"""Names of array types, which nearly every room imports."""

Imports = Mapping[str, frozenset[str]]
"""Rooms that each room imports from directly."""


def rooms() -> list[str]:
    """Names of the rooms, the top one first, from the first import contract."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return list(settings["tool"]["importlinter"]["contracts"][0]["layers"])


def imports_between(names: Sequence[str]) -> Imports:
    """Rooms that each room imports from, at least once in any of its files."""
    graph = grimp.build_graph(PACKAGE)
    found: dict[str, set[str]] = {name: set() for name in names}
    for module in graph.modules:
        for imported in graph.find_modules_directly_imported_by(module):
            source, target = (path.split(".")[1] if "." in path else "" for path in (module, imported))
            if source in found and target in found and source != target:
                found[source].add(target)
    return {name: frozenset(targets) for name, targets in found.items()}


def reduced(imports: Imports) -> Imports:
    """Leave out arrows that follow from others: a → c where a → b and b → c exist (transitive reduction)."""
    below: dict[str, frozenset[str]] = {}

    def reach(name: str) -> frozenset[str]:
        if name not in below:
            below[name] = imports[name].union(*(reach(target) for target in imports[name]))
        return below[name]

    return {
        name: frozenset(target for target in targets if not any(target in reach(other) for other in targets))
        for name, targets in imports.items()
    }


def mermaid(names: Sequence[str], imports: Imports) -> str:
    """Picture of the imports, as text for mermaid."""
    arrows = [
        f"    {name} --> {' & '.join(targets)}"
        for name in names
        if (targets := [other for other in names if other in imports[name] and other != NOT_DRAWN])
    ]
    return "\n".join(["```mermaid", "graph TD", *arrows, "```"])


def lines_of(name: str) -> int:
    """Lines of the Python files of a room, which is a package or a module."""
    path = ROOT / PACKAGE / name
    files = path.rglob("*.py") if path.is_dir() else [path.with_suffix(".py")]
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def table(names: Sequence[str], imports: Imports) -> str:
    """Lines, share and direct imports of each room, from the top."""
    lines = {name: lines_of(name) for name in names}
    total = sum(lines.values())
    rows = [
        f"| {number} | `{name}` | {lines[name]} | {100 * lines[name] / total:.1f} | {len(imports[name])} |"
        for number, name in enumerate(names, 1)
    ]
    largest = max(names, key=lambda name: lines[name])
    share = 100 * lines[largest] / total
    end = f"{total} lines in all. The largest room is `{largest}` with {share:.1f} % of them."
    head = ["| room | package or module | lines | % | rooms it imports from |", "|---|---|---|---|---|"]
    return "\n".join([*head, *rows, "", end])


def replaced(page: str, part: str, text: str) -> str:
    """Put a text between the two markers of a part of the page."""
    begin, end = f"<!-- {part}: begin, by scripts/import_graph.py -->", f"<!-- {part}: end -->"
    before, _, rest = page.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise SystemExit(f"{PAGE} has no markers of the part {part!r}")
    return f"{before}{begin}\n{text}\n{end}{after}"


def main() -> None:
    """Write both parts into the page, or print them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--print", action="store_true", dest="show", help="print instead of writing the page")
    names = rooms()
    imports = imports_between(names)
    parts = {"imports": mermaid(names, reduced(imports)), "lines": table(names, imports)}
    if parser.parse_args().show:
        print("\n\n".join(parts.values()))
        return
    page = PAGE.read_text(encoding="utf-8")
    for part, text in parts.items():
        page = replaced(page, part, text)
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
