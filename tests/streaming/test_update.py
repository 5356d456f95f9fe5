"""Samples of a store that are replaced: it is as if it had been built of the new ground."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.pyramids import CHUNK, contents, rugged

pytest.importorskip("zarr")

# two regions by three, and levels above them
SHAPE = 175, 290
# over the corner of four regions; a border of two; inside one
PARTS = (
    np.s_[120:140, 125:131],
    np.s_[128:129, 5:8],
    np.s_[10:11, 200:240],
)


def build(heights: np.ndarray, path: Path) -> Path:
    return tl.build(heights, path, chunk=CHUNK, spacing=30.0)


@pytest.mark.parametrize("part", PARTS)
def test_all_files_are_those_of_a_build_of_the_new_ground(
    tmp_path: Path, part: tuple[slice, slice]
) -> None:
    old = rugged(*SHAPE)
    new = old.copy()
    new[part] = 250.0
    new[part][0, 1] = np.nan
    terrain = tl.open(build(old, tmp_path / "a.tlod"), memory="50MB")
    x, y = (part[1].start + 2) * 30.0, -part[0].start * 30.0
    before = terrain.height_at([[x, y]])
    mask = np.isnan(new[part])
    terrain.update(*part, np.ma.masked_array(np.where(mask, -1e9, new[part]), mask))
    expected, found = contents(build(new, tmp_path / "b.tlod")), contents(tmp_path / "a.tlod")
    # the description has the fingerprint of a source that is none any more
    assert found.pop("zarr.json") != expected.pop("zarr.json")
    assert found == expected
    # and what was held is not what is shown
    assert before[0] != terrain.height_at([[x, y]])[0] == 250.0
    mesh = terrain.mesh(lod=tl.MaxErrorLod(5.0))
    assert tl.vertical_error(mesh, tl.Heightmap(new, spacing=30.0)).maximum <= 5.0
    assert terrain.height_range == pytest.approx((np.nanmin(new), 250.0))


def test_the_source_is_another_one_then(tmp_path: Path) -> None:
    path = build(rugged(*SHAPE), tmp_path / "a.tlod")
    tl.open(path, memory="50MB").update(slice(0, 1), slice(0, 1), [[7.0]])
    with pytest.raises(tl.InputError, match="begun with, got another one"):
        build(rugged(*SHAPE), path)
    assert tl.open(path, memory="50MB").height_at([[0.0, 0.0]])[0] == 7.0


def test_what_cannot_be_is_one_line_and_nothing_is_written(tmp_path: Path) -> None:
    path = build(rugged(*SHAPE), tmp_path / "a.tlod")
    terrain, before = tl.open(path, memory="50MB"), contents(path)
    one = slice(0, 1)
    for rows, columns, heights, said in (
        (slice(0, 176), one, [[1.0]] * 176, "expected rows within"),
        (one, one, [[1.0, 2.0]], "heights"),
        (one, one, [[np.inf]], "float32 can hold"),
        (one, one, [[1e39]], "float32 can hold"),
        (slice(None), slice(None), np.full(SHAPE, np.nan), "expected some data to be left"),
    ):
        with pytest.raises(tl.InputError, match=said):
            terrain.update(rows, columns, heights)
    assert contents(path) == before


def test_an_update_that_is_cut_off_leaves_a_store_that_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = build(rugged(*SHAPE), tmp_path / "a.tlod")
    terrain = tl.open(path, memory="50MB")
    monkeypatch.setattr("terrain_lod.pyramid.update.write_chunk_nodes", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        terrain.update(slice(0, 1), slice(0, 1), [[7.0]])
    with pytest.raises(tl.FileError, match="expected a finished store"):
        tl.open(path)
