"""Whole pyramids, read back from their files: errors, borders, levels, what a client is told."""

from __future__ import annotations

import json
from itertools import product

import numpy as np
import pytest
from matplotlib.tri import Triangulation
from pyproj import Transformer

import terrain_lod as tl
from support.tilesets import (
    centred,
    degrees,
    geographic_bounds,
    glb_parts,
    jacksboro,
    measured,
    mercator_bounds,
    read_glb,
    read_terrain,
    without_walls,
)

BOUNDS = {"geographic": geographic_bounds, "mercator": mercator_bounds}


@pytest.fixture(scope="module")
def ground():
    """Real ground across the border of two tiles of the deepest level."""
    return jacksboro()


@pytest.fixture(scope="module", params=["geographic", "mercator"])
def globe(request, ground, tmp_path_factory):
    """A pyramid of quantized-mesh: its report and its tiles, decoded."""
    folder = tmp_path_factory.mktemp(request.param)
    report = tl.write_tiles(ground, folder, scheme=request.param, error=8.0)
    tiles = {
        record.tile: read_terrain(folder / record.path, BOUNDS[request.param](*record.tile))
        for record in report.records
    }
    return report, tiles


def boxes(ground, folder, **options):
    """Write 3D Tiles of three levels, and return the report and the tiles."""
    report = tl.write_tiles(ground, folder, format="3dtiles", error=8.0, zoom=2, **options)
    west, south, east, north = root_bounds(folder)
    tiles = {}
    for record in report.records:
        z, x, y = record.tile
        width, height = (east - west) / 2**z, (north - south) / 2**z
        bounds = (west + x * width, south + y * height,
                  west + (x + 1) * width, south + (y + 1) * height)  # fmt: skip
        if record.path:
            tiles[record.tile] = read_glb(folder / record.path, bounds)
    return report, tiles


def root_bounds(folder):
    root = json.loads((folder / "tileset.json").read_text())["root"]
    return np.degrees(root["boundingVolume"]["region"][:4])


def in_stated_errors(tiles, samples):
    """Check every tile from outside, and return stated over measured."""
    ratios = []
    for tile, decoded in tiles.items():
        error, count = measured(decoded, samples)
        assert error <= decoded.error, tile
        if count:
            ratios.append(decoded.error / error)
    return ratios


@pytest.mark.slow
def test_no_sample_is_farther_from_a_tile_than_the_tile_says(globe, ground):
    report, tiles = globe
    ratios = in_stated_errors(tiles, degrees(ground))
    assert np.median(ratios) <= 1.25
    assert report.error <= 8.0


def test_tiles_of_a_level_share_their_borders_to_the_bit(globe):
    _, tiles = globe
    compared = 0
    for (z, x, y), tile in tiles.items():
        for other, own, theirs in (((z, x + 1, y), 2, 0), ((z, x, y + 1), 3, 1)):
            if other in tiles:
                ours, beside = tile.vertices[tile.edges[own]], tiles[other].vertices
                np.testing.assert_array_equal(ours, beside[tiles[other].edges[theirs]])
                compared += len(ours)
    assert compared > 20


def test_tiles_are_whole_squares_without_cracks(globe):
    for tile in globe[1].values():
        corners = tile.places[tile.triangles]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        assert areas.min() > 0
        assert areas.sum() == 2 * 32767**2
        sides = np.sort(np.stack([tile.triangles, np.roll(tile.triangles, -1, axis=1)], -1), -1)
        unique, counts = np.unique(sides.reshape(-1, 2), axis=0, return_counts=True)
        assert counts.max() == 2
        outer = tile.places[unique[counts == 1]]
        on_line = ((outer == 0) | (outer == 32767)).all(axis=1)
        assert on_line.any(axis=1).all()


def test_headers_hold_their_tile(globe):
    for tile in globe[1].values():
        centre, radius = np.array(tile.header[5:8]), tile.header[8]
        points = centred(tile.vertices)
        assert np.linalg.norm(points - centre, axis=1).max() <= radius + 1e-3
        low, high = tile.header[3:5]
        heights = tile.vertices[:, 2]
        assert low == heights.min()
        assert heights.max() <= high
        # seen from the horizon point, some of the tile is above the horizon
        assert np.linalg.norm(tile.header[9:12]) > 1


def test_normals_are_those_of_the_ground(globe):
    _, tiles = globe
    deepest = max(z for z, _, _ in tiles)
    for tile, decoded in tiles.items():
        if tile[0] == deepest:
            faces = np.cross(*(
                np.diff(centred(decoded.vertices[decoded.triangles[:, [0, corner]]]), axis=1)[:, 0]
                for corner in (1, 2)
            ))  # fmt: skip
            faces /= np.linalg.norm(faces, axis=1)[:, None]
            at_corners = decoded.normals[decoded.triangles].mean(axis=1)
            agreement = np.einsum("ij,ij->i", faces, at_corners)
            assert np.median(agreement) > 0.97


def test_a_client_is_told_of_every_tile(globe):
    report, tiles = globe
    layer = json.loads((report.folder / "layer.json").read_text())
    assert layer["extensions"] == ["octvertexnormals", "metadata"]
    told = {
        (z, x, y)
        for z, level in enumerate(layer["available"])
        for part in level
        for x in range(part["startX"], part["endX"] + 1)
        for y in range(part["startY"], part["endY"] + 1)
    }
    assert told == set(tiles)
    root = tiles[0, 0, 0]
    assert root.metadata["available"] == layer["available"][1:]


@pytest.mark.slow
@pytest.mark.parametrize("borders", ["skirts", "frozen"])
def test_tiles_with_errors_measured_meet_between_levels(ground, tmp_path, borders):
    report, tiles = boxes(ground, tmp_path, borders=borders)
    flat = {tile: without_walls(decoded) for tile, decoded in tiles.items()}
    ratios = in_stated_errors(flat, degrees(ground))
    assert np.median(ratios) <= 1.25
    assert report.error <= 8.0
    compared = 0
    for (z, x, y), tile in flat.items():
        if z == 2:
            continue
        for line, axis in product((0, 1), (0, 1)):
            for half in (0, 1):
                child = [2 * x + line, 2 * y + line]
                child[1 - axis] += half - line
                other = flat.get((z + 1, *child))
                if other is None:
                    continue
                # a border that both have, from a point on it to another
                coarse, fine = (_profile(one, axis, other.bounds[axis + 2 * line])
                                for one in (tile, other))  # fmt: skip
                shared = coarse[(coarse[:, 0] >= fine[0, 0] - 2e-7)
                                & (coarse[:, 0] <= fine[-1, 0] + 2e-7)]  # fmt: skip
                places = np.union1d(shared[:, 0], fine[:, 0])
                gap = np.interp(places, *coarse.T) - np.interp(places, *fine.T)
                compared += 1
                if borders == "frozen":
                    assert len(shared) == len(fine)
                    assert abs(gap).max() < 1e-6
                else:
                    assert 0 < abs(gap).max() <= report.asked[z] + report.asked[z + 1]
    assert compared > 8


def _profile(tile, axis, line):
    """Return the border's vertices, (B, 2): place along it and height; of degrees, 0 is x."""
    used = tile.vertices[np.unique(tile.triangles)]
    on_line = used[abs(used[:, axis] - line) < 2e-7]
    along = on_line[:, [1 - axis, 2]]
    return along[np.argsort(along[:, 0])]


@pytest.mark.slow
def test_walls_are_as_high_as_both_errors(ground, tmp_path):
    report, tiles = boxes(ground, tmp_path)
    for (z, _, _), tile in tiles.items():
        expected = report.asked[z] + report.asked[max(z - 1, 0)]
        upright = np.setdiff1d(np.arange(len(tile.vertices)), without_walls(tile).triangles)
        tops = _tops(tile, upright)
        # vertices are rounded to some millimetres
        np.testing.assert_allclose(tops - tile.vertices[upright, 2], expected, atol=0.02)


def _tops(tile, below):
    flat = np.unique(without_walls(tile).triangles)
    tops = []
    for vertex in below:
        away = np.hypot(*(tile.vertices[flat, :2] - tile.vertices[vertex, :2]).T)
        tops.append(tile.vertices[flat[away.argmin()], 2])
    return np.array(tops)


@pytest.mark.slow
@pytest.mark.parametrize("borders", ["none", "frozen"])
def test_boxes_of_a_level_share_their_borders_to_the_bit(ground, tmp_path, borders):
    report, tiles = boxes(ground, tmp_path, borders=borders)
    compared = 0
    for record in report.records:
        z, x, y = record.tile
        for other, axis in (((z, x + 1, y), 0), ((z, x, y + 1), 1)):
            if other in tiles:
                line = tiles[other].bounds[axis]
                both = []
                for tile in (record.tile, other):
                    _, points, _, _ = glb_parts(tmp_path / "{}/{}/{}.glb".format(*tile))
                    near = abs(tiles[tile].vertices[:, axis] - line) < 2e-7
                    both.append({tuple(point) for point in points[near].tolist()})
                assert both[0] == both[1]
                compared += len(both[0])
    assert compared > 100


@pytest.mark.slow
def test_holes_stay_holes_in_boxes(tmp_path):
    mask = np.zeros((90, 110), bool)
    mask[30:60, 40:90] = True
    ground = jacksboro(mask=mask)
    report, tiles = boxes(ground, tmp_path)
    samples = degrees(ground)
    in_stated_errors({tile: without_walls(decoded) for tile, decoded in tiles.items()}, samples)
    # nothing is drawn in the middle of the hole
    west, south, east, north = root_bounds(tmp_path)
    lon, lat = np.meshgrid(west + (east - west) * np.linspace(42, 87, 20) / 109,
                           north - (north - south) * np.linspace(32, 57, 20) / 89)  # fmt: skip
    for tile in tiles.values():
        flat = without_walls(tile)
        shape = Triangulation(flat.vertices[:, 0], flat.vertices[:, 1], flat.triangles)
        assert (shape.get_trifinder()(lon.ravel(), lat.ravel()) == -1).all()
    assert len(report.records) == len(tiles)


@pytest.mark.slow
@pytest.mark.parametrize("units", [("metre", "metre"), ("metre", "foot")])
def test_maps_that_stand_askew_and_heights_in_feet(units, tmp_path):
    ridge = tl.sample("ridge").elevation[:100, :120]
    metres = 0.3048 if units[1] == "foot" else 1.0
    ground = tl.Heightmap(ridge / metres, spacing=20.0, origin=(350_000.0, 5_100_000.0),
                          units=units)  # fmt: skip
    _, tiles = boxes(ground, tmp_path, crs="EPSG:32632", borders="none")
    row, column = np.indices(ground.shape)
    to_degrees = Transformer.from_crs("EPSG:32632", "EPSG:4326", always_xy=True)
    lon, lat = to_degrees.transform(350_000 + 20.0 * column, 5_100_000 - 20.0 * row)
    samples = np.stack([lon, lat, ridge], axis=-1).reshape(-1, 3)
    assert np.median(in_stated_errors(tiles, samples)) <= 1.25


def test_levels_of_the_whole_earth_are_measured_in_the_map_of_a_zone(tmp_path):
    # most of a tile's corners are where such a map is not
    ground = tl.Heightmap(np.indices((17, 17)).sum(axis=0) % 7, spacing=2.0, origin=(5e5, 4e6),
                          crs="EPSG:32632", units=("metre", "metre"))  # fmt: skip
    report = tl.write_tiles(ground, tmp_path / "tiles", zoom=3, scheme="mercator", error=40.0)
    assert [record.z for record in report.records] == [0, 1, 2, 3]
    assert all(record.error <= 320.0 / 2**record.z for record in report.records)
