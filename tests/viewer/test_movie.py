"""Recordings: MP4 where its extra is, and what they say where they cannot be."""

from __future__ import annotations

import gc
import sys

import numpy as np
import pytest

from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.viewer.movie import Movie


# imageio leaves the pipes to ffmpeg to the garbage collector
@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_mp4_with_its_extra(tmp_path):
    pytest.importorskip("imageio_ffmpeg", reason="no MP4 tested: terrain_lod[movie] is missing")
    import imageio

    movie = Movie(tmp_path / "fly.mp4")
    for level in (0, 120, 240):
        movie.add(np.full((61, 81, 3), level, np.uint8))
    movie.close()
    pictures = imageio.mimread(tmp_path / "fly.mp4")
    assert [round(float(picture.mean()), -1) for picture in pictures] == [0, 120, 240]
    assert pictures[0].shape[:2] == (60, 80)
    del movie
    gc.collect()


def test_recordings_say_what_they_need(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"ends in .gif or .mp4, got fly.avi"):
        Movie(tmp_path / "fly.avi")
    with pytest.raises(FileError, match="expected a folder"):
        Movie(tmp_path / "none" / "fly.gif")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtraError, match=r"terrain_lod\[movie\]"):
        Movie(tmp_path / "fly.mp4")
