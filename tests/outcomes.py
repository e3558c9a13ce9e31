"""What input may end in: a result, or one error of one line."""

import pytest

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


def refused(kind, call):
    """The error of this kind, and no other, that a call ends in: one line."""
    with pytest.raises(kind) as caught:
        call()
    assert kind is ExoidError or type(caught.value) is kind
    assert "\n" not in str(caught.value)
    return caught.value
