"""Says how many cases really ran."""

from cases import DONE


def pytest_terminal_summary(terminalreporter):
    if DONE:
        terminalreporter.write_line(f"{sum(DONE.values())} property cases: {dict(DONE)}")
