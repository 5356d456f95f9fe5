"""Recordings: MP4 where its extra is, and what they say where they cannot be."""

from __future__ import annotations

import gc
import os
import shutil
import sys

import numpy as np
import pytest
from PIL import Image

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


def test_gif_holds_every_picture_and_goes_to_the_disk_as_they_come(tmp_path):
    picture = np.full((60, 80, 3), 40, np.uint8)
    picture[10:20, 30:50] = 200, 10, 10
    pictures = [picture.copy()]
    for step in range(1, 6):
        picture[5 * step : 5 * step + 3, 7 * step] = 0, 250, 250 - step
        pictures.append(picture.copy())
    pictures.append(picture.copy())  # nothing new
    pictures.append(np.random.default_rng(3).integers(0, 255, (60, 80, 3), np.uint8))
    movie = Movie(tmp_path / "fly.gif")
    for shown in pictures:
        movie.add(shown)
        (temporary,) = tmp_path.iterdir()
        assert temporary.name != "fly.gif"
    movie.close()
    assert os.listdir(tmp_path) == ["fly.gif"]
    with Image.open(tmp_path / "fly.gif") as gif:
        assert gif.n_frames == len(pictures)
        assert gif.info["loop"] == 0
        for number, shown in enumerate(pictures[:-1]):
            gif.seek(number)
            assert gif.info["duration"] == 50
            assert (np.asarray(gif.convert("RGB")) == shown).all(), number
        gif.seek(len(pictures) - 1)
        noise = np.asarray(gif.convert("RGB")).astype(int) - pictures[-1]
    assert np.abs(noise).mean() < 30  # 256 colours
    # what stays is not written again
    still = Movie(tmp_path / "still.gif")
    for _ in range(9):
        still.add(pictures[-1])
    still.close()
    assert (tmp_path / "still.gif").stat().st_size < 2 * (tmp_path / "fly.gif").stat().st_size


@pytest.mark.slow
def test_a_long_recording_is_not_kept_in_memory(tmp_path):
    rng = np.random.default_rng(3)
    movie = Movie(tmp_path / "fly.gif")
    for _ in range(60):
        movie.add(rng.integers(0, 255, (60, 100, 3), np.uint8))
    (temporary,) = tmp_path.iterdir()
    assert temporary.stat().st_size > 50 * 60 * 100  # noise does not shrink
    movie.close()


def test_a_recording_without_pictures_or_without_its_end_leaves_nothing(tmp_path):
    Movie(tmp_path / "fly.gif").close()
    movie = Movie(tmp_path / "fly.gif")
    movie.add(np.zeros((20, 20, 3), np.uint8))
    del movie
    gc.collect()
    assert os.listdir(tmp_path) == []


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", ["fly.gif", "fly.mp4"])
def test_a_recording_that_cannot_be_written_says_so(tmp_path, name):
    if name == "fly.mp4":
        pytest.importorskip("imageio_ffmpeg", reason="no MP4 tested: terrain_lod[movie] is missing")
    picture = np.zeros((20, 20, 3), np.uint8)
    gone = tmp_path / "gone"
    gone.mkdir()
    movie = Movie(gone / name)
    movie.add(picture)
    shutil.rmtree(gone)
    movie.add(picture)
    with pytest.raises(FileError, match="cannot write"):
        movie.close()
    gone.mkdir()
    movie = Movie(gone / name)
    shutil.rmtree(gone)
    with pytest.raises(FileError, match="expected a folder"):
        movie.add(picture)
    gc.collect()


def test_recordings_say_what_they_need(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"ends in .gif or .mp4, got fly.avi"):
        Movie(tmp_path / "fly.avi")
    with pytest.raises(FileError, match="expected a folder"):
        Movie(tmp_path / "none" / "fly.gif")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtraError, match=r"terrain_lod\[movie\]"):
        Movie(tmp_path / "fly.mp4")
