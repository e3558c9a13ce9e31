"""Options that several verbs have mean the same in each."""

import pytest

from exoid.cli.options import LogOptions, given
from exoid.cli.verbs import VERBS, load_verb


@pytest.mark.parametrize("name", ["identify", "check", "validate", "interaction", "select", "plan", "view", "track"])
def test_every_verb_that_reads_logs_has_the_same_options_for_them(name):
    options = {option for each in load_verb(name).params for option in each.opts}
    own = {"--payload", "--base-position", "--wrench"} if name == "track" else set()  # there, the payload of the rig
    assert set(given(LogOptions())) - own <= options
    assert name in VERBS


def test_an_option_of_several_verbs_takes_the_same_kind_of_value_in_each():
    """Only what --output writes differs: each verb has a file of its own."""
    kinds = {}
    for name in VERBS:
        for each in load_verb(name).params:
            if each.param_type_name == "option" and each.metavar is not None:
                kinds.setdefault(each.opts[0], {}).setdefault(each.metavar, []).append(name)
    assert {option: found for option, found in kinds.items() if len(found) > 1 and option != "--output"} == {}
