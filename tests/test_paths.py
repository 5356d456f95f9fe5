"""Files appear whole or not at all."""

from __future__ import annotations

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
