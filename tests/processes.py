"""Programs in processes of their own."""

import subprocess
import sys


def run(*command, code=0, **options):
    """Run a command that ends with an exit status; return what it printed, of a failure on standard error."""
    words, given = [str(word) for word in command], {"timeout": 600, "encoding": "utf-8", **options}
    done = subprocess.run(words, capture_output=True, text=True, check=False, **given)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stderr if code else done.stdout


def run_python(program, *arguments, **options):
    """Run a program in a fresh interpreter."""
    return run(sys.executable, "-c", program, *arguments, **options)
