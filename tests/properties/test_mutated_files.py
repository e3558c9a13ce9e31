"""Mutated files of every kind end in a result or one line; ``scripts/mutate_files.py`` reads 20 000 of each."""

import mutate_files
import numpy as np
import pytest

import exoid

READ_HERE = ("csv", "mot", "forces.sto", "urdf", "estimate", "columns.toml", "drives.toml")
"""Kinds whose readers are Python, or are tested not to crash the process."""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A folder, and a valid file of each kind."""
    folder = tmp_path_factory.mktemp("mutated")
    return folder, mutate_files.seeds(folder)


@pytest.mark.parametrize("kind", READ_HERE)
def test_a_few_mutated_files_are_read_or_refused_in_one_line(files, kind):
    folder, contents = files
    rng, path = np.random.default_rng([28, READ_HERE.index(kind)]), folder / mutate_files.name_of(kind)
    read = mutate_files.reader_of(kind, folder)
    path.write_bytes(contents[kind])
    read(path)
    refused = []
    for _ in range(40):
        path.write_bytes(mutate_files.mutated(contents[kind], rng))
        try:
            read(path)
        except exoid.ExoidError as error:
            refused.append((error.what.strip(), str(error)))
    assert refused
    assert all(what and "\n" not in text for what, text in refused)
