"""Settings that every test shares."""

import functools
import gc
import json
import os
import sys
from typing import NamedTuple

# Before the first import of numpy: many small matrices, and one process for each core.
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

os.environ.pop("COLUMNS", None)  # texts as a pipe receives them

import pytest
from browser import chromium
from hypothesis import settings
from swings import Swing

import exoid
from exoid.cli import main
from exoid.torques.catalog import TERMS

settings.register_profile("exoid", deadline=None, derandomize=True, database=None, print_blob=False)
settings.load_profile("exoid")

gc.disable()  # while tests are collected: many objects, and hardly one of them is garbage

BUILT_IN = [
    (name, side, inertias)
    for name, sets in (("bleex", ("cad", "identified")), ("cuhk", ("nominal",)))
    for inertias in sets
    for side in ("left", "right")
]


@functools.cache
def reason_to_skip(name, *arguments):
    """Why a dataset is not to be had here; empty if it is. A damaged file is an error."""
    try:
        getattr(exoid.datasets, name)(*arguments)
    except exoid.ExoidError as error:
        if "cannot be downloaded" not in error.what:
            raise
        return f"{name} is neither in $EXOID_DATA_DIR nor to be downloaded: {error.remedy}"
    return ""


@pytest.hookimpl(tryfirst=True)  # before fixtures, which load the data
def pytest_runtest_setup(item):
    """Tests marked ``real_data("name of a dataset")`` are skipped where the dataset is not to be had."""
    for mark in item.iter_markers("real_data"):
        if reason := reason_to_skip(*mark.args):
            pytest.skip(reason)


LONGEST = (
    *("test_identification_on_ground", "test_changes", "test_coordinated_loop", "test_docs_pages", "test_rail"),
    *("test_ground_scenarios", "test_population", "test_elastic_joints", "test_efforts", "test_recursive"),
    *("test_cuhk_replay", "test_lift", "test_steppers", "test_coordinate_command", "test_packaging"),
)
"""Names of files whose slow tests take ten seconds and more."""


def pytest_collection_modifyitems(items):
    """The longest files begin, so that no process is left with one of them at the end."""
    items.sort(key=lambda item: item.path.stem not in LONGEST)


def pytest_collection_finish():
    """From here on garbage is looked for among new objects, not again and again among all tests and libraries."""
    gc.freeze()
    gc.enable()


def pytest_xdist_auto_num_workers(config):
    """Tests whose output is to be seen (``pytest -s``) run in this process, else in one for each core."""
    return 0 if config.option.capture == "no" else None


@pytest.fixture(params=BUILT_IN, ids="-".join, scope="session")
def built_in_leg(request):
    """Each built-in leg, on both sides and with every inertia set."""
    name, side, inertias = request.param
    return exoid.load_leg(name, side=side, inertias=inertias)


@pytest.fixture(scope="session")
def leg():
    return exoid.load_leg("bleex")


@pytest.fixture(scope="session")
def cuhk_leg():
    return exoid.load_leg("cuhk")


@pytest.fixture(scope="session")
def swing(leg):
    """Motion of 20 s at 100 Hz, with friction."""
    return Swing(leg)


@pytest.fixture(scope="session")
def exo():
    return exoid.load_exo("bleex", base="floating")


@pytest.fixture(scope="session")
def data():
    """The example that comes along."""
    return exoid.datasets.bleex_swing()


@pytest.fixture(scope="session")
def estimate(data):
    """That of the example, with all checks."""
    return exoid.identify(data.leg, data.train)


@pytest.fixture(params=["left", "right"])
def side(request):
    return request.param


@pytest.fixture
def forgetful(monkeypatch):
    """Registries that have afterwards what they had before."""
    monkeypatch.setattr(TERMS, "classes", dict(TERMS.classes))


@pytest.fixture(scope="session")
def browser():
    """A Chromium to open pages in; tests that ask for it are skipped where there is none."""
    with chromium() as running:
        yield running


class Run(NamedTuple):
    """Exit status, standard output and standard error."""

    code: int
    out: str
    err: str

    @property
    def printed(self):
        """What a command printed that ended well."""
        assert self.code == 0, self.err
        return self.out

    @property
    def data(self):
        """The same of ``--json``, read."""
        return json.loads(self.printed)

    @property
    def refusal(self):
        """The line of a command that was refused: all that it printed."""
        assert (self.code, self.out, self.err.count("\n")) == (2, "", 1), self
        assert self.err.startswith("exoid: ")
        return self.err


@pytest.fixture
def exoid_(capsys, monkeypatch, tmp_path):
    """Run ``exoid ARGUMENTS`` in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys.modules["__main__"], "__package__", None)  # usage lines of "python -m pytest" are the same

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["exoid", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return Run(int(stop.value.code or 0), *capsys.readouterr())

    return run


@pytest.fixture
def saved(exoid_, estimate):
    """The estimate of the example, in ``est.json`` of the current folder."""
    estimate.save("est.json")
    return estimate
