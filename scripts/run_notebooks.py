"""Execute notebooks and store what they print, so that the site and GitHub show it.

``python scripts/run_notebooks.py`` runs all, ``python scripts/run_notebooks.py 4 7`` those whose names begin so.
``--check`` stores nothing: texts that differ from those stored are an error. It compares neither pictures nor numbers
below 1e-9, which are rounding. ``--words``, as in ``.ci/run``, compares no number: other processors round, and plan,
otherwise. It needs ``pip install -e '.[test]'``. Each notebook runs in an
interpreter of its own, in an empty folder. What differs between two runs of the same code is left out: counts of
executions, times, versions of the interpreter, addresses of objects, and the name of the folder.
"""

from __future__ import annotations

import re
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from difflib import unified_diff
from functools import partial
from pathlib import Path
from time import monotonic

import nbformat
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"

LANGUAGE = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
"""Metadata of a stored notebook: what is needed to open it."""

ADDRESS = re.compile(r" at 0x[0-9a-f]{6,}")

ROUNDING = re.compile(r"\d\.?\d*e-[1-9]\d")
"""Numbers below 1e-9, which another processor rounds otherwise."""

NUMBER = re.compile(r"[-+]?\d[\d.,]*(e[-+]?\d+)?")

LONGEST = 600
"""Time that a cell may take [s]."""


def main() -> None:
    """Execute the notebooks that the command line names by their beginnings, all without one."""
    check, words = "--check" in sys.argv, "--words" in sys.argv
    named = [each for each in sys.argv[1:] if each not in ("--check", "--words")]
    beginnings = tuple(f"{each}_" if each.isdigit() else each for each in named) or ("",)
    chosen = [path for path in sorted(NOTEBOOKS.glob("*.ipynb"), key=number) if path.name.startswith(beginnings)]
    if not chosen:
        sys.exit(f"no notebook in {NOTEBOOKS} begins with {' or '.join(beginnings)}")
    if check or words:
        with ProcessPoolExecutor(2) as pool:
            stale = "".join(pool.map(partial(compare, words=words), chosen))
        sys.exit(f"{stale}python scripts/run_notebooks.py stores what they print now" if stale else 0)
    for path in chosen:
        start = monotonic()
        changed = store(path)
        print(f"{path.name}: {'stored' if changed else 'unchanged'}, {monotonic() - start:.0f} s", flush=True)


def number(path: Path) -> int:
    """Number at the beginning of a notebook's name, by which they are read.

    Args:
        path: The notebook.

    Returns:
        The number.
    """
    return int(path.name.partition("_")[0])


def store(path: Path) -> bool:
    """Execute a notebook and write it back with its outputs.

    Args:
        path: The notebook.

    Returns:
        Whether the file changed.
    """
    before = path.read_text(encoding="utf-8")
    after = nbformat.writes(executed(before))
    after = after if after.endswith("\n") else f"{after}\n"
    path.write_text(after, encoding="utf-8")
    return after != before


def compare(path: Path, *, words: bool) -> str:
    """Execute a notebook and compare what it prints with what it stores.

    Args:
        path: The notebook.
        words: Whether words alone are compared, without numbers, spaces and rules of tables.

    Returns:
        The difference; empty if there is none.
    """
    before = path.read_text(encoding="utf-8")
    texts = [printed(nbformat.reads(before, as_version=4)), printed(executed(before))]
    if words:  # lines break elsewhere where a number has another digit
        texts = [re.sub(r"[\s─]+", "\n", NUMBER.sub("", "\n".join(lines))).splitlines() for lines in texts]
    difference = unified_diff(*texts, f"{path.name}, stored", f"{path.name}, now", n=0, lineterm="")
    return "".join(f"{line}\n" for line in difference)


def executed(text: str) -> nbformat.NotebookNode:
    """Execute a notebook in an empty folder.

    Args:
        text: The notebook, as JSON.

    Returns:
        The notebook with its outputs.

    Raises:
        CellExecutionError: A cell failed.
    """
    notebook = nbformat.reads(text, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=LONGEST, kernel_name="python3", resources=at(folder)).execute()
        clean(notebook, folder)
    return notebook


def printed(notebook: nbformat.NotebookNode) -> list[str]:
    """Lines of text that a notebook prints.

    Args:
        notebook: A notebook with its outputs.

    Returns:
        The lines.
    """
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    texts = [output.text if output.output_type == "stream" else output.data.get("text/plain", "") for output in outputs]
    return ROUNDING.sub("0", "\n".join(texts)).splitlines()


def at(folder: str) -> dict[str, dict[str, str]]:
    """Resources of a run in a folder.

    Args:
        folder: The folder.

    Returns:
        What nbclient calls resources.
    """
    return {"metadata": {"path": folder}}


def clean(notebook: nbformat.NotebookNode, folder: str) -> None:
    """Leave out what differs between two runs of the same code, in place.

    Args:
        notebook: An executed notebook.
        folder: Folder in which it ran.
    """
    notebook.metadata = nbformat.from_dict(LANGUAGE)
    count = 0
    for cell in notebook.cells:
        cell.metadata = nbformat.from_dict({key: value for key, value in cell.metadata.items() if key == "tags"})
        if cell.cell_type != "code":
            continue
        count += 1
        cell.execution_count = count
        cell.outputs = [cleaned(output, count, folder) for output in joined(cell.outputs)]


def joined(outputs: list[nbformat.NotebookNode]) -> list[nbformat.NotebookNode]:
    """Join pieces of one stream, which arrive in another number at each run.

    Args:
        outputs: Outputs of a cell.

    Returns:
        The outputs; texts of a stream that follow each other are one.
    """
    found: list[nbformat.NotebookNode] = []
    for output in outputs:
        if found and output.output_type == found[-1].output_type == "stream" and output.name == found[-1].name:
            found[-1].text += output.text
        else:
            found.append(output)
    return found


def cleaned(output: nbformat.NotebookNode, count: int, folder: str) -> nbformat.NotebookNode:
    """Take addresses, metadata and the folder out of an output.

    Args:
        output: An output.
        count: Number of its cell.
        folder: Folder in which the notebook ran.

    Returns:
        The output.
    """
    if "execution_count" in output:
        output.execution_count = count
    if "metadata" in output:
        output.metadata = nbformat.from_dict({})
    if output.output_type == "stream":
        output.text = ADDRESS.sub("", output.text.replace(folder, "."))
    elif "data" in output and "text/plain" in output.data:
        output.data["text/plain"] = ADDRESS.sub("", output.data["text/plain"].replace(folder, "."))
    return output


if __name__ == "__main__":
    main()
