"""Manners in notebooks and pyvista: HTML of the objects, the accessor, cell data, the example."""

from __future__ import annotations

import re
from base64 import b64decode
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import pyvista
from PIL import Image

from support.grounds import holed, rough
from terrain_lod import (
    Camera,
    Heightmap,
    MaxErrorLod,
    Mesh,
    Terrain,
    UniformLod,
)
from terrain_lod.drawing.graphics import graphics_problem

EXAMPLES = Path(__file__).parents[2] / "examples"
ACCESSORS = pytest.mark.skipif(
    not hasattr(pyvista, "register_dataset_accessor"), reason="pyvista before 0.48 has no accessors"
)


def checked(html):
    """Make sure that every tag is closed, and return the table's cells."""

    class Reader(HTMLParser):
        def __init__(self):
            super().__init__()
            self.open, self.cells = [], []

        def handle_starttag(self, tag, attrs):
            if tag != "img":
                self.open.append(tag)
            if tag in ("th", "td"):
                self.cells.append("")

        def handle_endtag(self, tag):
            assert self.open.pop() == tag

        def handle_data(self, data):
            if self.open and self.open[-1] in ("th", "td"):
                self.cells[-1] += data

    reader = Reader()
    reader.feed(html)
    assert not reader.open
    return dict(zip(reader.cells[::2], reader.cells[1::2], strict=True))


def test_heightmap_shows_its_numbers_and_itself_from_above():
    ground = holed(100, 77, spacing=(30.0, 20.0), name="<b>evil</b>", crs="EPSG:32610")
    html = ground._repr_html_()
    table = checked(html)
    assert table["samples"] == "100 × 77"
    assert table["spacing"] == "30 × 20"
    assert table["CRS"] == "EPSG:32610"
    assert table["nodata"].split()[0] == f"{int(ground.mask.sum()):,}"
    assert "<b>evil</b>" not in html
    data = b64decode(re.search(r"base64,([^']+)'", html)[1])
    picture = np.asarray(Image.open(BytesIO(data)))
    assert picture.shape == (100, 77, 3)
    assert (picture[5, 5] > 240).all()  # a hole
    assert picture.std() > 5


def test_terrain_and_mesh_show_theirs():
    terrain = Terrain(rough(61, 46, spacing=5.0), levels=1)
    table = checked(terrain._repr_html_())
    assert table["tiles"] == "4 × 3 of 15 cells"
    assert table["device"] == terrain.device.info.name
    mesh = terrain.mesh(lod=MaxErrorLod(2.0))
    table = checked(mesh._repr_html_())
    assert table["triangles"] == f"{len(mesh.triangles):,}"
    assert table["patches"] == "12 drawn, 0 culled"
    assert float(table["largest error"].split(",")[0]) <= 2.0


@pytest.mark.parametrize("ground", [Heightmap([[0, 1], [2, 3]]), Heightmap(np.zeros((2, 900)))])
def test_the_smallest_and_the_thinnest_are_shown(ground):
    checked(ground._repr_html_())
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    assert checked(empty._repr_html_())["triangles"] == "0"


def test_cell_data_is_that_of_the_patches():
    mesh = Terrain(holed(100, 77), levels=1).mesh(lod=UniformLod(5.0))
    surface = mesh.to_pyvista()
    patch = mesh.triangle_patches
    assert (surface["patch"] == patch).all()
    # tiles with holes are meshed in full, the others as asked
    factors = mesh.patches.inside_factors.max(axis=1)[patch]
    assert (surface["factor"] == factors).all()
    assert set(surface["level"][factors == 5.0]) == {2}
    assert set(surface["level"][factors == 15.0]) == {4}
    assert (surface["deviation"] == mesh.patches.deviation[patch]).all()


@ACCESSORS
def test_accessor_is_there_without_an_import_and_goes_back_and_forth(tmp_path):
    ground = rough(61, 61, spacing=10.0, origin=(5e5, 4e6), crs="EPSG:32610")
    mesh = Terrain(ground).mesh(lod=UniformLod(15.0))
    again = mesh.to_pyvista().terrain_lod.mesh()
    assert (again.vertices == mesh.vertices).all()
    assert (again.triangles == mesh.triangles).all()
    assert (again.origin == mesh.origin).all()
    assert again.crs == "EPSG:32610"
    surface = mesh.to_pyvista()
    assert surface.terrain_lod.vertical_error(ground).maximum < 0.01
    assert not surface.terrain_lod.crack_report()
    assert surface.terrain_lod.save(tmp_path / "ground.glb").exists()
    cube = pyvista.Cube().terrain_lod.mesh()  # quads, without an origin
    assert len(cube.triangles) == 12
    assert np.linalg.norm(cube.normals, axis=1) == pytest.approx(np.ones(len(cube.normals)))


@ACCESSORS
@pytest.mark.parametrize("north", [0.0, 4_000_000.0])
def test_accessor_keeps_what_float64_points_hold(north):
    ground = rough(61, 61, spacing=0.5, origin=(500_000.125, north + 0.0625))
    mesh = Terrain(ground).mesh()
    surface = mesh.to_pyvista()
    surface.points = mesh.vertices.astype(np.float64) + mesh.origin  # as VTK's readers give them
    del surface.field_data["origin"]
    again = surface.terrain_lod.mesh()
    # float32 alone would move them by up to 0.25 m
    found = again.vertices.astype(np.float64) + again.origin
    np.testing.assert_allclose(found, surface.points, rtol=0, atol=1e-4)
    assert surface.terrain_lod.vertical_error(ground).maximum < 1e-2 * np.ptp(ground.height_range)
    # an origin that is known is moved along
    surface.points = surface.points - (1000.0, 0.0, 0.0)
    surface.field_data["origin"] = (1000.0, 0.0, 0.0)
    moved = surface.terrain_lod.mesh()
    np.testing.assert_allclose(moved.vertices + moved.origin, found, rtol=0, atol=1e-4)


@ACCESSORS
def test_accessor_keeps_texture_coordinates():
    corners = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    textures = corners[:, :2] / 2
    mesh = Mesh(
        corners,
        np.tile(np.float32([0, 0, 1]), (3, 1)),
        np.int32([[0, 1, 2]]),
        np.zeros(3),
        textures=textures,
    )
    back = mesh.to_pyvista().terrain_lod.mesh()
    np.testing.assert_array_equal(back.textures, textures)


@pytest.mark.filterwarnings("default")  # of Jupyter's own
@pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no notebook tested: {graphics_problem()}"
)
@pytest.mark.slow
def test_the_example_notebook_runs():
    nbclient = pytest.importorskip("nbclient", reason="no notebook tested: nbclient is missing")
    import nbformat

    notebook = nbformat.read(EXAMPLES / "ground_to_mesh.ipynb", as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells)  # kept clean in the repository
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    shown = [set(output.get("data", {})) for output in outputs]
    assert sum("text/html" in kinds for kinds in shown) == 3
    assert any("image/png" in kinds for kinds in shown)


def test_camera_and_mesh_in_one_line():
    camera = Camera((0, -50, 30), (0, 0, 0))
    mesh = Terrain(rough(31, 31)).mesh(camera)
    assert "pixels" in checked(mesh._repr_html_())["largest error"]
