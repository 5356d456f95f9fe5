"""MapLibre itself, asked for the heights of terrain-RGB that we wrote."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.client_page import library, opened
from support.tilesets import jacksboro, places
from terrain_lod.tilesets.serve import Site

pytestmark = pytest.mark.slow

ELEVATIONS = "return given[0].map(place => tiles.map.queryTerrainElevation(place))"
LEVELS = """
    const { tileManager } = tiles.map.terrain
    return tileManager.getRenderableTiles().map(
        tile => tileManager.getSourceTile(tile.tileID, true).tileID.canonical.z)
"""
PICTURE = "return tiles.map.getCanvas().toDataURL()"


@pytest.mark.parametrize("encoding", ["terrarium", "mapbox"])
def test_heights_are_within_what_was_stated(encoding, tmp_path):
    maplibre, ground = library("maplibre-gl"), jacksboro()
    report = tl.write_tiles(ground, tmp_path, format=encoding)
    samples = places(ground)
    with opened(Site.of(report.folder, maplibre)) as page:
        page.wait("window.tiles?.ready")
        # from straight above, all of the view has one level
        page.ask("tiles.map.jumpTo({ pitch: 0 }); await tiles.map.once('idle')")
        heights = np.array(page.ask(ELEVATIONS, samples[:, :2].tolist()), float)
        drawn = min(page.ask(LEVELS))
        stated = max(record.error for record in report.records if record.z == drawn)
        assert drawn > 8
        assert abs(heights - samples[:, 2]).max() <= stated
        assert page.picture(PICTURE).astype(float).mean(axis=2).std() > 5
        assert page.ask("return tiles.failed") == []
        assert page.complaints() == []
        assert page.elsewhere() == []
