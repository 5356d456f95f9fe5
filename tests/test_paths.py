"""Files appear whole or not at all."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from terrain_lod.errors import FileError
from terrain_lod.paths import replacing, require_folder, require_made


def test_file_appears_when_it_is_whole(tmp_path):
    path = tmp_path / "mesh.glb"
    path.write_text("old")
    with replacing(path) as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".glb"  # writers go by the ending
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("failure", [ValueError("no triangles"), KeyboardInterrupt()])
def test_nothing_is_left_of_what_failed(tmp_path, failure):
    path = tmp_path / "mesh.glb"
    path.write_text("old")

    def write():
        with replacing(path) as temporary:
            temporary.write_text("half of i")
            raise failure

    with pytest.raises(type(failure)):
        write()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_disk_errors_name_the_file(tmp_path):
    with (
        pytest.raises(FileError, match=r"cannot write .*mesh\.glb: No space left on device"),
        replacing(tmp_path / "mesh.glb"),
    ):
        raise OSError(28, "No space left on device")


def test_no_folder_to_write_in(tmp_path):
    with pytest.raises(FileError, match=r"expected a folder to write a\.png in, got none at"):
        require_folder(tmp_path / "no" / "a.png")
    with pytest.raises(FileError, match="expected a file name to write, got the folder"):
        require_folder(tmp_path)


def test_folders_are_made(tmp_path):
    assert require_made(tmp_path / "a" / "b").is_dir()
    assert require_made(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="cannot make the folder"):
        require_made(tmp_path / "file" / "b")


def test_a_name_as_long_as_a_file_system_takes(tmp_path):
    path = tmp_path / ("x" * 250 + ".glb")
    with replacing(path) as temporary:
        temporary.write_text("new")
    assert path.read_text() == "new"
    with (
        pytest.raises(FileError, match=r"cannot write .*: File name too long"),
        replacing(tmp_path / ("x" * 300 + ".glb")),
    ):
        raise AssertionError("the work began")
    (tmp_path / ("a." + "x" * 250)).write_text("an ending may be as long")
    with replacing(tmp_path / ("a." + "x" * 250)) as temporary:
        temporary.write_text("new")


def test_two_writers_of_one_name_do_not_meet(tmp_path):
    path, both_write = tmp_path / "mesh.glb", threading.Barrier(2)
    paths = []

    def write(text: str) -> None:
        with replacing(path) as temporary:
            temporary.write_text(text)
            both_write.wait(timeout=10)
            assert temporary.read_text() == text
            paths.append(temporary)

    threads = [threading.Thread(target=write, args=(text,)) for text in ("one", "two")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(paths)) == 2
    assert path.read_text() in ("one", "two")
    assert list(tmp_path.iterdir()) == [path]


WAIT_TO_BE_KILLED = """
import sys, time
from terrain_lod.paths import replacing
with replacing(sys.argv[1]) as temporary:
    temporary.write_text("half of i")
    print("writing", flush=True)
    time.sleep(60)
"""


def killed(path, number) -> int:
    """Return the exit status of a process that gets a signal while it writes `path`."""
    command = [sys.executable, "-c", WAIT_TO_BE_KILLED, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
        assert child.stdout.readline() == b"writing\n"
        child.send_signal(number)
        return child.wait(timeout=30)


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
def test_what_kills_a_writer_leaves_nothing_for_long(tmp_path):
    path = tmp_path / "mesh.glb"
    path.write_text("old")
    # asked to end, it tidies up
    assert killed(path, signal.SIGTERM) == 128 + signal.SIGTERM
    assert list(tmp_path.iterdir()) == [path]
    # killed, it cannot: the next does, when it is sure that nobody writes there any more
    assert killed(path, signal.SIGKILL) == -signal.SIGKILL
    (left,) = set(tmp_path.iterdir()) - {path}
    with replacing(path) as temporary:
        temporary.write_text("new")
    assert left.exists()
    two_hours_ago = time.time() - 7200
    os.utime(left, (two_hours_ago, two_hours_ago))
    with replacing(tmp_path / "other.glb") as temporary:
        temporary.write_text("of another name")
    assert left.exists()
    with replacing(path) as temporary:
        temporary.write_text("newer")
    assert sorted(tmp_path.iterdir()) == [path, tmp_path / "other.glb"]
    assert path.read_text() == "newer"


def test_a_handler_of_sigterm_is_left_alone(tmp_path):
    before = signal.getsignal(signal.SIGTERM)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with replacing(tmp_path / "mesh.glb") as temporary:
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
            temporary.write_text("new")
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before)
