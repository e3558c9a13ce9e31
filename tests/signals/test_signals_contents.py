"""The room's table of contents."""

from __future__ import annotations

from exoid import signals


def test_the_table_of_contents_is_sorted_and_every_name_in_it_exists_and_is_explained():
    assert signals.__all__ == sorted(signals.__all__, key=lambda name: (not name.isupper(), name))
    for name in signals.__all__:
        assert getattr(signals, name).__doc__
