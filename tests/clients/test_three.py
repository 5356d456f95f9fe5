"""three.js itself: a tile's GLB stands where its samples are on the Earth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.client_page import library, opened
from support.tilesets import centred, jacksboro, places
from terrain_lod.tilesets.serve import Site

pytestmark = pytest.mark.slow

HIGH = 9000.0


def test_rays_meet_a_tile_at_the_heights_of_samples(tmp_path):
    three, ground = library("three"), jacksboro()
    report = tl.write_tiles(ground, tmp_path, format="3dtiles", error=8.0, borders="none")
    samples = places(ground)
    above = centred(np.column_stack([samples[:, :2], np.full(200, HIGH)]))
    up = above - centred(np.column_stack([samples[:, :2], np.full(200, HIGH - 1)]))
    site = Site(report.folder, Path(__file__).with_name("three.html"), {"/library/": three})
    with opened(site) as page:
        page.wait("window.tiles?.ready")
        below = page.ask("return tiles.below(...given)", above.tolist(), up.tolist())
        heights = HIGH - np.array(below, float)
        assert abs(heights - samples[:, 2]).max() <= report.records[0].error
        picture = page.picture(f"return tiles.picture({up[0].tolist()})")
        assert picture.astype(float).mean(axis=2).std() > 8
        assert page.complaints() == []
        assert page.elsewhere() == []
