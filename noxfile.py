"""Tasks by name: ``nox --list`` shows them, ``nox -s tests`` runs one. They run in the environment that is active."""

import nox

nox.options.default_venv_backend = "none"
nox.options.sessions = ["style", "contracts", "types", "tests"]


@nox.session
def style(session: nox.Session) -> None:
    """Lint, format and docstrings of exported names."""
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("pydoclint", "-q", "exoid")


@nox.session
def contracts(session: nox.Session) -> None:
    """Imports between the rooms."""
    session.run("lint-imports")


@nox.session
def types(session: nox.Session) -> None:
    """Types, strictly."""
    session.run("mypy")


@nox.session
def tests(session: nox.Session) -> None:
    """Tests without slow ones: the README's command."""
    session.run("pytest", "-p", "no:cacheprovider", *session.posargs)


@nox.session
def slow(session: nox.Session) -> None:
    """What the README's command leaves out: slow tests and those that need real data."""
    wanted = "(slow or real_data) and not nightly"
    # A file stays in one process: what its tests share, such as a replay, is made once. The longest come first.
    options = ("--dist", "loadfile", "--no-loadscope-reorder", "--durations", "25")
    session.run("pytest", "-p", "no:cacheprovider", "-m", wanted, *options, *session.posargs)


@nox.session
def nightly(session: nox.Session) -> None:
    """Studies with many repetitions, and replays of documents."""
    session.run("pytest", "-p", "no:cacheprovider", "-m", "nightly", *session.posargs)


@nox.session
def benchmarks(session: nox.Session) -> None:
    """Speed ratios, alone: a ratio measured beside other work is not worth an assertion."""
    session.run("pytest", "-p", "no:cacheprovider", "-n", "0", "-s", "tests/benchmarks", *session.posargs)


@nox.session
def notebooks(session: nox.Session) -> None:
    """All notebooks, executed: they print the words that they store."""
    session.run("python", "scripts/run_notebooks.py", "--words")


@nox.session
def site(session: nox.Session) -> None:
    """Site of the documentation; any warning fails. Needs ``pip install '.[docs]'``."""
    target = session.posargs or ["site"]
    session.run("mkdocs", "build", "--quiet", "--strict", "--site-dir", *target, env={"NO_MKDOCS_2_WARNING": "1"})


@nox.session
def golden(session: nox.Session) -> None:
    """Numbers of all golden journeys, compared with the stored ones."""
    session.run("python", "scripts/golden.py", "--compare", "scripts/golden.json", *session.posargs)
