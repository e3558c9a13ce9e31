"""Published files are fetched at a commit, checked by their hash, and found where they were put."""

import pooch
import pytest

from exoid import ExoidError, datasets
from exoid.signals.datasets import dfki, sydney, teststand

FILES = {
    "dfki": (datasets.dfki_double_pendulum, dfki.LOG, dfki.COMMIT),
    "inner": (lambda: datasets.sydney_swing_leg("inner"), sydney.LOGS["inner"], sydney.COMMIT),
    "outer": (lambda: datasets.sydney_swing_leg("outer"), sydney.LOGS["outer"], sydney.COMMIT),
    "teststand": (datasets.teststand_leg, teststand.URDF, teststand.URDF_COMMIT),
}
"""What loads the data, the published file, and the commit that it is fetched at."""


@pytest.mark.parametrize(("load", "published", "commit"), FILES.values(), ids=FILES)
@pytest.mark.parametrize("folder", ["", "empty"])
def test_without_a_network_the_error_says_what_to_fetch_and_where_to_put_it(
    load, published, commit, folder, tmp_path, monkeypatch
):
    asked = []

    def offline(url, sha, **_):
        asked.append((url, sha))
        raise OSError("Name or service not known\nsecond line")

    monkeypatch.setenv("EXOID_DATA_DIR", str(tmp_path / folder) if folder else "")
    monkeypatch.setattr(pooch, "retrieve", offline)
    with pytest.raises(ExoidError, match=r"cannot be downloaded \(Name or service not known second line\)") as error:
        load()
    ((url, sha),) = asked
    assert sha == f"sha256:{published.sha256}"
    assert commit in url
    assert " " not in url
    assert error.value.where == url
    assert error.value.remedy == f"download it to $EXOID_DATA_DIR/{published.file}"


@pytest.mark.parametrize(("load", "published", "commit"), FILES.values(), ids=FILES)
def test_a_file_that_is_not_the_published_one_is_refused(load, published, commit, tmp_path, monkeypatch):
    (tmp_path / published.file).parent.mkdir()
    (tmp_path / published.file).write_text("<robot/>", encoding="utf-8")
    monkeypatch.setenv("EXOID_DATA_DIR", str(tmp_path))
    with pytest.raises(ExoidError, match=r"not the published file: its hash differs.*delete it, or unset"):
        load()
