"""B-splines exactly, Catmull-Clark surfaces nearly; both without cracks."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial import cKDTree

import terrain_lod as tl
from terrain_lod.curved.catmull_clark import catmull_clark_patches
from terrain_lod.curved.control_mesh import ControlMesh, Rings
from terrain_lod.reference.curved.bezier import field


def box(creases=(), open_side=False):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return ControlMesh(corners, sides[open_side:], creases)


def prism(sides):
    """Return a prism: its lids refined have a vertex of so many neighbours each."""
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles), np.ones(sides)], axis=1)
    walls = [(i, i + sides, (i + 1) % sides + sides, (i + 1) % sides) for i in range(sides)]
    lids = [range(sides), range(2 * sides - 1, sides - 1, -1)]
    return ControlMesh(np.concatenate([ring, ring * (1, 1, -1)]), [*lids, *walls])


RING = [(1, 3), (3, 7), (7, 5), (5, 1)]
MESHES = {
    "cube": box(),
    "sharp ring": box(RING),
    "a crease that ends": box([(0, 1)]),
    "all sharp": box([(a, b) for a in range(8) for b in range(a) if (a ^ b) in (1, 2, 4)]),
    **{f"prism of {n}": prism(n) for n in (3, 5, 8, 30)},
}  # fmt: skip


@pytest.mark.parametrize("closed", [(False, False), (True, False), (True, True)])
def test_b_splines_are_exact(closed):
    random = np.random.default_rng(1)
    points = random.normal(size=(7, 6, 3))
    nets = tl.curved.b_spline(points, closed=closed)
    pieces = [n if each else n - 3 for n, each in zip((7, 6), closed, strict=True)]
    assert len(nets) == np.prod(pieces)
    for axis, each in enumerate(closed):
        if each:
            points = np.concatenate([points, np.take(points, range(3), axis=axis)], axis=axis)
    along_u, along_v = (BSpline(np.arange(n + 4.0), np.eye(n), 3) for n in points.shape[:2])
    u, v = random.uniform(size=(2, len(nets)))
    i, j = np.arange(len(nets)) % pieces[0], np.arange(len(nets)) // pieces[0]
    expected = np.einsum("pi,pj,ijk->pk", along_u(3 + i + u), along_v(3 + j + v), points)
    np.testing.assert_allclose(field(nets, u, v), expected, atol=1e-12)


def test_closed_b_splines_are_closed():
    u, v = np.meshgrid(*2 * [2 * np.pi * np.arange(8) / 8], indexing="ij")
    wide = 3 + np.cos(v)
    ring = np.stack([np.cos(u) * wide, np.sin(u) * wide, np.sin(v)], axis=-1)
    torus = tl.curved.bezier(tl.curved.b_spline(ring, closed=(True, True)), factor=5)
    assert not tl.crack_report(torus, closed=True)


@pytest.mark.parametrize("name", MESHES)
def test_surfaces_are_closed_for_every_formula(name):
    camera = tl.Camera((4, 3, 2), (0, 0, 0), size=(640, 480))
    for how in ({"factor": 4.3}, {"lod": tl.curved.LengthFactor(pixels=9), "camera": camera}):
        found = tl.curved.catmull_clark(MESHES[name], **how)
        assert not tl.crack_report(found, closed=True)
        assert np.isfinite(found.vertices).all()
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-5)


@pytest.mark.parametrize("name", ["cube", "sharp ring", "prism of 5", "prism of 8"])
def test_patches_are_near_the_surface(name):
    mesh = MESHES[name].refined()
    ends = MESHES[name].vertices[Rings.of(MESHES[name]).edge_ends]
    edge = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean()
    # the corners of a finer mesh's patches are points of the surface
    fine = mesh
    for _ in range(4):
        fine = fine.refined()
    points = catmull_clark_patches(fine).nets[:, 0, 0]
    found = tl.curved.catmull_clark(mesh, factor=31)
    _, nearest = cKDTree(found.vertices).query(points)
    off = points - found.vertices[nearest]
    assert np.abs((off * found.normals[nearest]).sum(axis=1)).max() < 0.006 * edge


def test_regular_patches_are_the_surface():
    fine = MESHES["cube"].refined().refined().refined()
    valence = np.bincount(Rings.of(fine).starts)
    regular = (valence[fine.quads] == 4).all(axis=1)
    patches, finer = catmull_clark_patches(fine), catmull_clark_patches(fine.refined())
    middle = np.full(len(fine.faces), 0.5)
    # corner 2 of a quad's first child is its middle
    expected = finer.nets[::4][:, 3, 3]
    assert regular.any()
    np.testing.assert_allclose(
        field(patches.nets, middle, middle)[regular], expected[regular], atol=1e-14
    )


@pytest.mark.parametrize("name", ["cube", "prism of 3", "prism of 8", "prism of 30"])
def test_normals_are_the_same_on_both_sides_of_an_edge(name):
    found = tl.curved.catmull_clark(MESHES[name], factor=9)
    _, place = np.unique(found.vertices, axis=0, return_inverse=True)
    order = np.argsort(place.ravel(), kind="stable")
    together = [(a, b) for a, b in pairwise(order) if place.ravel()[a] == place.ravel()[b]]
    a, b = np.array(together).T
    assert (found.normals[a] * found.normals[b]).sum(axis=1).min() > 1 - 1e-5


def test_creases_are_sharp_and_outlines_stay():
    flat = tl.curved.catmull_clark(MESHES["all sharp"], factor=3)
    assert np.isin(flat.vertices.max(axis=1), [1.0]).any()
    np.testing.assert_allclose(flat.vertices.max(axis=0), 1, atol=1e-7)
    rim = tl.curved.catmull_clark(box(open_side=True), factor=9)
    assert len(tl.crack_report(rim).__repr__()) > 0
    # the outline is the cubic B-spline of its four corners, in their plane
    on_rim = np.abs(rim.vertices[:, 0]) < 1e-7
    assert on_rim.sum() >= 4 * 9


def test_obj_files_of_quads_are_read(tmp_path):
    lines = [f"v {x} {y} {z}" for x, y, z in box().vertices]
    lines += ["vt 0 0"] + [
        f"f {' '.join(f'{corner + 1}/1' for corner in face)}" for face in box().faces
    ]
    (tmp_path / "box.obj").write_text("\n".join(lines))
    found = tl.curved.catmull_clark(tmp_path / "box.obj", factor=3)
    expected = tl.curved.catmull_clark(box(), factor=3)
    assert len(found.triangles) == len(expected.triangles)
    np.testing.assert_allclose(np.sort(found.vertices, axis=0), np.sort(expected.vertices, axis=0))


def test_odd_control_meshes_give_finite_surfaces():
    pillow = ControlMesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3), (3, 2, 1, 0)])
    point = ControlMesh(np.zeros((4, 3)), [(0, 1, 2, 3)])
    loose = ControlMesh(np.random.default_rng(2).normal(size=(8, 3)), [(0, 1, 2, 3), (4, 5, 6)])
    book = ControlMesh(
        [(0, 0, 0), (0, 0, 1), *((np.cos(a), np.sin(a), z) for a in (0, 2, 4) for z in (1, 0))],
        [(0, 1, 2, 3), (0, 1, 4, 5), (0, 1, 6, 7)],
    )
    for mesh in (pillow, point, loose, book):
        found = tl.curved.catmull_clark(mesh, factor=3)
        assert np.isfinite(found.vertices).all()
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ControlMesh([(0, 0)], []), "vertices of shape"),
        (lambda: ControlMesh(np.zeros((4, 3)), [(0, 1)]), "three or more different corners"),
        (lambda: ControlMesh(np.zeros((4, 3)), [(0, 1, 1, 2)]), "three or more different corners"),
        (lambda: ControlMesh(np.zeros((3, 3)), [(0, 1, 3)]), "corners below 3"),
        (lambda: ControlMesh(np.zeros((4, 3)), [(0, 1, 2, 3)], [(0, 2)]), "creases that are edges"),
        (lambda: tl.curved.catmull_clark(ControlMesh(np.zeros((1, 3)), [])), "faces, got none"),
        (lambda: tl.curved.catmull_clark(box(), factor=0), "factor > 0"),
        (lambda: tl.curved.b_spline(np.zeros((3, 4, 3))), "control points"),
        (lambda: tl.curved.b_spline(np.full((4, 4, 3), np.nan)), "finite control points"),
    ],
)
def test_bad_input_is_one_line(make, message):
    with pytest.raises(tl.InputError, match=message) as error:
        make()
    assert "\n" not in str(error.value)
