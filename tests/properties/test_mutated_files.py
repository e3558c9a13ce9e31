"""Mutated files of every kind end in a result or one line; ``scripts/mutate_files.py`` reads 20 000 of each."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import exoid

SCRIPT = Path(__file__).parents[2] / "scripts" / "mutate_files.py"

READ_HERE = ("csv", "mot", "forces.sto", "urdf", "estimate", "columns.toml", "drives.toml")
"""Kinds whose readers are Python, or are tested not to crash the process."""


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """The script, a folder, and a valid file of each kind."""
    found = importlib.util.spec_from_file_location("mutate_files", SCRIPT)
    module = importlib.util.module_from_spec(found)
    sys.modules["mutate_files"] = module  # its dataclasses look it up
    found.loader.exec_module(module)
    folder = tmp_path_factory.mktemp("mutated")
    return module, folder, module.seeds(folder)


@pytest.mark.parametrize("kind", READ_HERE)
def test_a_few_mutated_files_are_read_or_refused_in_one_line(script, kind):
    module, folder, contents = script
    rng, path = np.random.default_rng([28, READ_HERE.index(kind)]), folder / module.name_of(kind)
    read = module.reader_of(kind, folder)
    path.write_bytes(contents[kind])
    read(path)
    refused = []
    for _ in range(40):
        path.write_bytes(module.mutated(contents[kind], rng))
        try:
            read(path)
        except exoid.ExoidError as error:
            refused.append((error.what.strip(), str(error)))
    assert refused
    assert all(what and "\n" not in text for what, text in refused)
