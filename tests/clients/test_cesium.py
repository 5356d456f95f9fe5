"""CesiumJS itself, asked for the heights of tiles that we wrote: the ground's, as stated."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from skimage.metrics import structural_similarity

import terrain_lod as tl
from support.client_page import library, opened
from support.tilesets import centred, jacksboro, places
from terrain_lod.tilesets.serve import Site

pytestmark = pytest.mark.slow

PICTURE = """
    const { viewer } = tiles
    viewer.useDefaultRenderLoop = false
    viewer.scene.render()
    return viewer.scene.canvas.toDataURL()
"""
SAMPLE = """
    const places = given.map(([lon, lat]) => Cesium.Cartographic.fromDegrees(lon, lat))
    const found = await Cesium.sampleTerrainMostDetailed(tiles.provider, places)
    return found.map(place => place.height ?? null)
"""
# what is drawn: the triangles themselves. Cesium looks for those of a tileset on the line from the
# place to the Earth's middle, which leans from the ellipsoid's normal by a fifth of a degree: from
# height 0 it meets ground 500 m high some 1.6 m beside the place. So each place is asked for once
# more at the height that was found, until both are the same.
DRAWN = """
    const { viewer: { scene }, tileset } = tiles
    const found = place => tileset ? tileset.getHeight(place, scene) : scene.globe.getHeight(place)
    return given.map(([lon, lat]) => {
        let height = 0
        for (let turn = 0; turn < 4 && height !== null; turn++)
            height = found(Cesium.Cartographic.fromDegrees(lon, lat, height)) ?? null
        return height
    })
"""
# one of ten looks around the ground, from low and from high
LOOK = """
    const { viewer: { camera }, tileset } = tiles
    const { west, south, east, north } = tileset.root.boundingVolume.rectangle
    const metres = (north - south) * 6.4e6
    const middle = Cesium.Cartesian3.fromRadians((west + east) / 2, (south + north) / 2, 600)
    camera.lookAt(middle, new Cesium.HeadingPitchRange(
        given * Math.PI / 5, -(0.3 + 0.1 * given), (1.3 - 0.08 * given) * metres))
    camera.lookAtTransform(Cesium.Matrix4.IDENTITY)
"""
LEVELS = "return tiles.viewer.scene.globe._surface._tilesToRender.map(tile => tile.level)"
FINE = "tiles.tileset.maximumScreenSpaceError = given[0]"
LOADED = "(tiles.tileset ?? tiles.viewer.scene.globe).tilesLoaded"


@pytest.fixture(scope="module")
def cesium():
    return library("cesium")


@pytest.fixture(scope="module")
def ground():
    return jacksboro()


@pytest.fixture(scope="module")
def samples(ground):
    return places(ground)


@pytest.fixture(scope="module")
def globe(ground, tmp_path_factory):
    folder = tmp_path_factory.mktemp("globe")
    return tl.write_tiles(ground, folder, error=8.0)


@pytest.fixture(scope="module")
def boxes(ground, tmp_path_factory):
    folder = tmp_path_factory.mktemp("boxes")
    return tl.write_tiles(ground, folder, format="3dtiles", error=8.0, zoom=2)


def asked(page, script, samples):
    """Return the heights that a client says, NaN where it has none."""
    return np.array(page.ask(script.replace("given", "given[0]"), samples[:, :2].tolist()), float)


def require_clean(page):
    assert page.ask("return tiles.failed") == []
    assert page.complaints() == []
    assert page.elsewhere() == []


def require_ground(picture):
    """Check that a picture shows ground: much of it shaded, none of it torn to the sky."""
    grey = picture.astype(float).mean(axis=2)
    assert grey.std() > 8
    sky = (abs(picture.astype(int) - [158, 195, 230]).max(axis=2) < 3).mean()
    assert sky < 0.6


def worst_of(page, script, samples):
    return float(abs(asked(page, script, samples) - samples[:, 2]).max())


def test_heights_of_the_globe_are_within_what_was_stated(cesium, globe, samples):
    with opened(Site.of(globe.folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        assert worst_of(page, SAMPLE, samples) <= globe.error
        page.settle(LOADED)
        levels = page.ask(LEVELS)
        # levels below the deepest are cut out of it
        drawn = min(max(levels), globe.records[-1].z)
        stated = max(record.error for record in globe.records if record.z >= min(drawn, *levels))
        # triangles on the graphics card have 12 bits a coordinate: half a step of the tile's size
        assert worst_of(page, DRAWN, samples) <= stated + 1
        require_ground(page.picture(PICTURE))
        require_clean(page)


@pytest.mark.parametrize("tiling", ["implicit", "explicit"])
def test_heights_of_boxes_are_within_what_was_stated(
    cesium, ground, boxes, samples, tiling, tmp_path
):
    report = boxes
    if tiling == "explicit":
        report = tl.write_tiles(
            ground, tmp_path, format="3dtiles", error=8.0, zoom=2, tiling="explicit"
        )
    with opened(Site.of(report.folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        for pixels, level in ((16.0, 0), (0.001, 2)):
            page.ask(FINE, pixels)
            page.settle(LOADED)
            stated = max(record.error for record in report.records if record.z == level)
            assert worst_of(page, DRAWN, samples) <= stated
        selected = page.ask("return tiles.tileset.statistics.selected")
        assert selected == sum(record.z == 2 for record in report.records)
        require_ground(page.picture(PICTURE))
        require_clean(page)


def similarity(one, other):
    """Return the mean structural similarity of two pictures; 1 where they are equal."""
    return structural_similarity(one, other, channel_axis=-1)


def pictures(folder, cesium):
    """Return pictures of all that is deepest, from ten cameras."""
    with opened(Site.of(folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        page.ask(FINE, 0.001)
        found = []
        for number in range(10):
            page.ask("tiles.viewer.useDefaultRenderLoop = true")
            page.ask(LOOK.replace("given", str(number)))
            page.settle(LOADED)
            found.append(page.picture(PICTURE))
        require_clean(page)
    return found


def test_no_seam_is_visible_from_ten_cameras(cesium, ground, tmp_path):
    whole, tiled = tmp_path / "whole", tmp_path / "tiled"
    options = {"format": "3dtiles", "error": 2.0, "tiling": "explicit"}
    tl.write_tiles(ground, whole, zoom=0, borders="none", **options)
    tl.write_tiles(ground, tiled, zoom=2, **options)
    seen = [pictures(folder, cesium) for folder in (whole, tiled)]
    for picture in seen[0]:
        require_ground(picture)
    alike = [similarity(*pair) for pair in zip(*seen, strict=True)]
    assert min(alike) > 0.9, alike
    # one tile of sixteen that stands 40 m too high is a seam
    _lift(tiled / "tileset.json", "2/1/1.glb")
    torn = pictures(tiled, cesium)
    worse = [similarity(*pair) for pair in zip(seen[0], torn, strict=True)]
    assert all(worse[i] < alike[i] - 0.005 for i in range(10)), (alike, worse)


def _lift(path, uri):
    tileset = json.loads(path.read_text())
    west, south, east, north = np.degrees(tileset["root"]["boundingVolume"]["region"][:4])
    middle = np.array([(west + east) / 2, (south + north) / 2])
    foot, top = (centred(np.array([*middle, height])) for height in (0.0, 40.0))
    nodes = [tileset["root"]]
    for node in nodes:
        nodes += node.get("children", [])
    (node,) = (node for node in nodes if node["content"]["uri"] == uri)
    node["transform"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *(top - foot), 1]
    path.write_text(json.dumps(tileset))


def test_wrong_heights_are_seen(cesium, ground, samples, tmp_path):
    raised = tl.Heightmap(ground.elevation + 20, spacing=ground.spacing, origin=ground.origin,
                          crs=ground.crs)  # fmt: skip
    report = tl.write_tiles(raised, tmp_path, error=8.0)
    with opened(Site.of(report.folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        assert worst_of(page, SAMPLE, samples) > report.error


def test_truncated_tiles_are_seen(cesium, globe, samples, tmp_path):
    folder = Path(shutil.copytree(globe.folder, tmp_path / "broken"))
    for record in globe.records:
        if record.z == globe.records[-1].z:
            path = folder / record.path
            path.write_bytes(path.read_bytes()[:200])
    with opened(Site.of(folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        assert not worst_of(page, SAMPLE, samples) <= globe.error


def test_a_missing_subtree_is_seen(cesium, boxes, samples, tmp_path):
    folder = Path(shutil.copytree(boxes.folder, tmp_path / "broken"))
    (folder / "subtrees/0/0/0.subtree").unlink()
    with opened(Site.of(folder, cesium)) as page:
        page.wait("window.tiles?.ready")
        page.wait("tiles.failed.length")
        assert not worst_of(page, DRAWN, samples) <= boxes.records[0].error
