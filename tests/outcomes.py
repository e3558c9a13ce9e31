"""What any input may end in."""

from exoid import ExoidError


def outcome(function, *args, **options):
    """What a function gives, or the one error it may end in: one line, with a remedy; never anything else."""
    try:
        return function(*args, **options)
    except ExoidError as error:
        refused = error
    assert "\n" not in str(refused)
    assert refused.what.strip()
    return refused
