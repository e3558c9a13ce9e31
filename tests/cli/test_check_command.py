"""``exoid check`` prints findings; they do not change the exit status."""

from swings import late

import exoid


def test_a_log_without_faults(exoid_):
    assert exoid_("check", "bleex", "bleex_swing:train") == (0, "nothing found\n", "")


def test_a_late_log_as_table_and_json(exoid_):
    log = exoid.datasets.bleex_swing().train
    late(log, 0.02, range(3)).to_csv("late.csv")
    assert "torque-delay" in exoid_("check", "bleex", "late.csv").printed
    (finding,) = exoid_("check", "bleex", "late.csv", "--json").data["findings"]
    assert finding["kind"] == "torque-delay"
    assert abs(finding["value"] - 0.02) < 0.001
    mended = exoid_("identify", "bleex", "late.csv", "--delay", "auto", "--json")
    assert [f["severity"] for f in mended.data["findings"]] == ["info"] * 3
    silent = exoid_("identify", "bleex", "late.csv", "--no-check", "--json")
    assert silent.data["findings"] == []
