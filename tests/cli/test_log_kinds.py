"""The commands read logs of every kind alike."""

import pytest
from log_writers import messages, write_bag

import exoid


@pytest.fixture(scope="module")
def recording():
    return exoid.datasets.bleex_swing().train


def test_the_topic_and_the_stamps_of_a_bag_are_options(exoid_, recording, tmp_path):
    recording = recording.slice(0, 1000)
    write_bag(tmp_path / "bag", {"/left": messages(recording), "/right": messages(recording)}, late=10**6)
    code, out, err = exoid_("identify", "bleex", "bag")
    assert (code, out) == (2, "")
    assert err.startswith("exoid: bag: 2 topics of joint states: /left, /right")
    assert err.count("\n") == 1
    assert exoid_("identify", "bleex", "bag", "--no-check", "--topic", "/right", "--received")[0] == 0
    recording.to_csv(tmp_path / "log.csv")
    assert exoid_("identify", "bleex", "log.csv", "--topic", "/right")[0] == 2
