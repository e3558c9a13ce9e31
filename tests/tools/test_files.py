"""Outputs never replace an input, keep links and modes, and survive other writers."""

import os
import stat
from pathlib import Path

import pytest

import exoid
from exoid import Estimate, ExoidError
from exoid.tools.files import make_folder, refuse_input, refuse_unwritable, write_together, write_whole

posix = pytest.mark.skipif(os.name != "posix", reason="links, modes and pipes of POSIX")

WRITERS = {
    "write_whole": lambda path: write_whole(path, ["new"]),
    "write_together": lambda path: write_together({Path(path): "new"}),
}


@pytest.fixture(params=WRITERS)
def write(request):
    return WRITERS[request.param]


def test_what_a_killed_writer_left_an_hour_ago_is_removed_and_what_is_younger_stays(write, tmp_path):
    old, young, other = (
        tmp_path / f".{file}.{two * 8}.part" for file, two in (("file", "0a"), ("file", "0b"), ("x", "0a"))
    )
    for part in (old, young, other):
        part.touch()
    for part in (old, other):
        os.utime(part, (0.0, 0.0))
    write(tmp_path / "file")
    assert {*tmp_path.iterdir()} == {tmp_path / "file", young, other}


@posix
def test_a_link_stays_a_link_and_its_file_is_written(write, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "file").write_text("old")
    (tmp_path / "link").symlink_to(Path("elsewhere") / "file")
    write(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "elsewhere" / "file").read_text() == "new"
    (tmp_path / "dangling").symlink_to("later")
    write(tmp_path / "dangling")
    assert (tmp_path / "dangling").is_symlink()
    assert (tmp_path / "later").read_text() == "new"


@posix
@pytest.mark.parametrize("mode", [0o600, 0o664, 0o755])
def test_a_file_keeps_its_mode(write, tmp_path, mode):
    file = tmp_path / "file"
    file.write_text("old")
    file.chmod(mode)
    write(file)
    assert stat.S_IMODE(file.stat().st_mode) == mode
    assert file.read_text() == "new"


@posix
def test_a_new_file_has_the_mode_that_the_umask_gives(write, tmp_path):
    before = os.umask(0o027)
    try:
        write(tmp_path / "file")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o640


@posix
def test_devices_pipes_and_circles_of_links_are_refused(write, tmp_path):
    """The device is a terminal, whose folder takes no files: a writer that fails this test does no harm to it."""
    os.mkfifo(tmp_path / "pipe")
    master, slave = os.openpty()
    (tmp_path / "device").symlink_to(os.ttyname(slave))
    (tmp_path / "circle").symlink_to("circle")
    for name, what in (("pipe", "device or a pipe"), ("device", "device or a pipe"), ("circle", "circle")):
        for action in (write, refuse_unwritable):
            with pytest.raises(ExoidError, match=what):
                action(tmp_path / name)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    assert (tmp_path / "device").is_symlink()
    os.close(master)
    os.close(slave)


@pytest.mark.parametrize("name", ["a\0b", "x" * 300])
def test_names_that_no_file_can_have_end_in_one_line(write, tmp_path, name):
    for action in (write, refuse_unwritable):
        with pytest.raises(ExoidError, match="cannot be written"):
            action(f"{tmp_path}/{name}")


def test_rights_are_checked_by_a_real_file_that_is_removed(tmp_path):
    refuse_unwritable(tmp_path / "file")
    assert not list(tmp_path.iterdir())
    if Path("/proc/self").is_dir():
        with pytest.raises(ExoidError, match="cannot be written"):
            refuse_unwritable("/proc/self/file")  # a folder whose mode permits it, even to root
        with pytest.raises(ExoidError, match="cannot write files"):
            make_folder("/proc/self")


def test_an_input_is_refused_under_any_of_its_names(tmp_path):
    (tmp_path / "logs").mkdir()
    log = tmp_path / "logs" / "log.csv"
    log.write_text("time")
    refuse_input(tmp_path / "new.csv", [log, "bleex"])
    refuse_input(log, [tmp_path / "new.csv", "bleex"])
    names = [log, tmp_path / "logs" / ".." / "logs" / "log.csv"]
    if os.name == "posix":
        (tmp_path / "link").symlink_to(log)
        os.link(log, tmp_path / "hard")
        names += [tmp_path / "link", tmp_path / "hard"]
    for name in names:
        with pytest.raises(ExoidError, match="is an input"):
            refuse_input(name, [log])
    with pytest.raises(ExoidError, match="is an input"):
        refuse_input(log, [tmp_path / "logs"])
    refuse_input(tmp_path / "logs" / "new.json", [tmp_path / "logs"])


@pytest.fixture(scope="module")
def estimate(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("estimate")
    data.train.to_csv(folder / "log.csv")
    (folder / "cad.urdf").write_bytes(b"\xef\xbb\xbf" + data.leg.description.text.encode())
    leg = exoid.Leg.from_urdf(folder / "cad.urdf", data.train.joint_names)
    found = exoid.identify(leg, exoid.Recording.from_csv(folder / "log.csv"))
    found.save(folder / "est.json")
    return folder


@pytest.mark.parametrize(("method", "name"), [("save", "log.csv"), ("to_urdf", "cad.urdf"), ("to_urdf", "log.csv")])
def test_an_estimate_knows_its_inputs_by_their_content(estimate, method, name):
    before = (estimate / name).read_bytes()
    with pytest.raises(ExoidError, match="is an input, which the output would replace"):
        getattr(Estimate.load(estimate / "est.json"), method)(estimate / name)
    assert (estimate / name).read_bytes() == before
