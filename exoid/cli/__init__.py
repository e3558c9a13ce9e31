"""The command line: one verb, one file."""

from .app import app, main

__all__ = ["app", "main"]
