"""Kernels of PN-triangles: bits on shared edges, accuracy, hard cases."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import CLOSED, torus
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.pn import DevicePatchMesh, evaluate_on_device, nets_on_device
from terrain_lod.curved.smooth import pn_triangles
from terrain_lod.reference.curved import pn
from terrain_lod.tessellation.tessellator import tessellate_device


def curved(vertices, normals, triangles, factor=5.0, partitioning="fractional_odd"):
    """Return adjacency, pattern points (N, 3) as weights, their patches, positions and normals."""
    mesh = tl.Mesh(
        np.asarray(vertices, np.float32),
        np.asarray(normals, np.float32),
        np.asarray(triangles, np.int32).reshape(-1, 3),
    )
    device = tl.Device.open()
    adjacency = Adjacency.of(mesh)
    patches = DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
    edges, inside = (np.full((patches.count, n), factor, np.float32) for n in (3, 1))
    pattern = tessellate_device(
        "triangle", device.array(edges), device.array(inside), partitioning, clockwise=True
    )
    nets = nets_on_device(patches)
    found = evaluate_on_device(nets, pattern)
    points = pattern.points.host() / 65536
    weights = np.column_stack([points, 1 - points.sum(axis=1)])
    patch = np.repeat(np.arange(patches.count), np.diff(pattern.point_offsets.host().astype(int)))
    return adjacency, weights, patch, found.positions.host(), found.normals.host(), nets.host()


def random_triangles(count: int, scale: float = 1.0, offset: float = 0.0):
    rng = np.random.default_rng(0)
    vertices = (rng.normal(size=(3 * count, 3)) * scale + offset).astype(np.float32)
    normals = rng.normal(size=(3 * count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return vertices, normals.astype(np.float32), np.arange(3 * count).reshape(-1, 3)


@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1.0, 100.0), (1e-2, 1000.0)])
def test_ten_thousand_random_triangles_within_4_ulp(scale: float, offset: float) -> None:
    vertices, normals, triangles = random_triangles(10_000, scale, offset)
    adjacency, weights, patch, positions, unit, nets = curved(vertices, normals, triangles)
    wide = vertices.astype(np.float64), normals.astype(np.float64)
    controls = pn.control_points(adjacency.patches, *wide)
    ulp = np.spacing(np.abs(vertices.reshape(-1, 9)).max(axis=1))
    # control points: a third of a lift off the straight edge
    first, second = [1, 2, 2, 0, 0, 1], [2, 1, 0, 2, 1, 0]
    corners = wide[0].reshape(-1, 3, 3)
    edges = (2 * corners[:, first] + corners[:, second] + nets[:, 3:9]) / 3
    off = np.abs(edges - controls[:, 3:9]).max(axis=(1, 2))
    middle = corners.mean(axis=1) + nets[:, 9].astype(np.float64) / 6
    off = np.maximum(off, np.abs(middle - controls[:, 9]).max(axis=1))
    assert (off / ulp).max() < 4
    # points on the surface
    expected = pn.positions_at(controls[patch], weights)
    assert (np.abs(positions - expected).max(axis=1) / ulp[patch]).max() < 4
    # corners are the mesh's own, to the bit
    at = weights.max(axis=1) == 1
    corner = 3 * patch[at] + weights[at].argmax(axis=1)
    np.testing.assert_array_equal(positions[at], vertices[corner])
    # normals
    assert np.abs(np.linalg.norm(unit.astype(np.float64), axis=1) - 1).max() < 1e-6
    blended = pn.normals_at(
        pn.control_normals(adjacency.patches, *wide)[patch], corners[patch], weights
    )
    # the weakest of the blends are sums of vectors that all but cancel
    np.testing.assert_allclose(unit, blended, atol=1e-4)
    assert np.quantile(np.abs(unit - blended), 0.999) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("partitioning", ["fractional_odd", "integer"])
@pytest.mark.parametrize("factor", [1.0, 2.0, 2.5, 3.7, 64.0])
def test_both_sides_of_an_edge_have_the_same_bits(factor: float, partitioning: str) -> None:
    mesh = torus(8, 5)
    adjacency, weights, patch, positions, normals, _ = curved(
        mesh.vertices, mesh.normals, mesh.triangles, factor, partitioning
    )
    seen: dict[int, set[bytes]] = {}
    for side in range(3):
        on_edge = weights[:, side] == 0
        for edge in np.unique(adjacency.edges[:, side]):
            of_edge = on_edge & (adjacency.edges[patch, side] == edge)
            for own in np.unique(patch[of_edge]):
                both = np.hstack([positions, normals])[of_edge & (patch == own)] + np.float32(0)
                points = {row.tobytes() for row in both}
                assert seen.setdefault(int(edge), points) == points
    assert len(seen) == len(adjacency.sides)


UP = [0, 0, 1]
HARD = {
    "no area": ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [UP] * 3),
    "one point": ([[5, 5, 5]] * 3, [UP] * 3),
    "two equal corners": ([[0, 0, 0], [0, 0, 0], [1, 0, 0]], [UP] * 3),
    "needle of 1 : 10^6": ([[0, 0, 0], [1e6, 0, 0], [1e6, 1, 0]], [UP, [1, 0, 0], [0, 1, 0]]),
    "opposite normals": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [UP, [0, 0, -1], UP]),
    "all opposite": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 0], [0, -1, 0], [1, 0, 0]]),
    "no normals": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0]] * 3),
    "normals along edges": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0]] * 3),
    "tiny": ([[0, 0, 0], [1e-22, 0, 0], [0, 1e-22, 0]], [UP] * 3),
    "huge": ([[0, 0, 0], [1e15, 0, 0], [0, 1e15, 0]], [UP, [0.6, 0, 0.8], UP]),
}


@pytest.mark.parametrize("name", HARD)
@pytest.mark.parametrize("linear", ["linear", "quadratic"])
def test_hard_cases_have_finite_results(name: str, linear: str) -> None:
    vertices, normals = (np.array(values, np.float32) for values in HARD[name])
    mesh = tl.Mesh(vertices, normals, np.int32([[0, 1, 2]]))
    smooth = pn_triangles(mesh, 5, normals=linear)
    assert np.isfinite(smooth.vertices).all()
    lengths = np.linalg.norm(smooth.normals.astype(np.float64), axis=1)
    np.testing.assert_allclose(lengths, 1, atol=1e-6)
    for corner in vertices:
        assert (smooth.vertices == corner).all(axis=1).any()
    if np.ptp(vertices, axis=0).max() == 0:
        assert (smooth.vertices == vertices[0]).all()
    if not normals.any():  # the plane triangle's stand in
        np.testing.assert_array_equal(smooth.normals, np.broadcast_to(UP, smooth.normals.shape))
        np.testing.assert_array_equal(smooth.vertices[:, 2], 0)


def test_far_from_the_origin_edges_of_a_hundredth_keep_their_shape() -> None:
    # positions are relative to the mesh's float64 origin: a million away nothing is lost
    near = torus()
    small = tl.Mesh(near.vertices * np.float32(0.01), near.normals, near.triangles)
    far = tl.Mesh(small.vertices, small.normals, small.triangles, np.full(3, 1e6))
    np.testing.assert_array_equal(pn_triangles(small, 5).vertices, pn_triangles(far, 5).vertices)


def test_three_triangles_at_an_edge_share_its_curve() -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    triangles = [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
    lean = np.array([[-0.6, 0, 0.8], [0.6, 0, 0.8], UP, UP, UP])
    adjacency, weights, patch, positions, *_ = curved(vertices, lean, triangles)
    assert (adjacency.patches[:, 3:9] >= 0).all()
    common = [{p.tobytes() for p in positions[(patch == k) & (weights[:, 2] == 0)]} for k in (0, 2)]
    assert common[0] == common[1]
    assert positions[(patch == 0) & (weights[:, 2] == 0), 2].max() > 0.05  # the edge is curved
    # with normals of their own they cannot agree: the edge is straight, and closed
    own = np.concatenate([np.array(vertices)[corner] for corner in triangles])
    normals = np.tile([[-0.6, 0, 0.8], [0.6, 0, 0.8], UP], (3, 1))
    normals[3:6] = UP
    adjacency, weights, patch, positions, *_ = curved(own, normals, np.arange(9))
    assert (adjacency.patches[0, 7:9] == -1).all()
    for triangle, side in ((0, 2), (1, 2), (2, 2)):
        on_edge = (patch == triangle) & (weights[:, side] == 0)
        np.testing.assert_array_equal(positions[on_edge][:, 1:], 0)


def test_patches_of_twelve_indices_as_drawn() -> None:
    #  2---3      two triangles with vertices of their own: 0 1 2 and 4 5 6 at the places of
    #  |\  |      1 3 2; they share the edge 1-2
    #  | \ |
    #  0---1
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    triangles = np.int32([[0, 1, 2], [4, 5, 6]])
    mesh = tl.Mesh(np.float32(vertices), np.tile(np.float32(UP), (7, 1)), triangles)
    adjacency = Adjacency.of(mesh)
    np.testing.assert_array_equal(
        adjacency.patches,
        [
            # corners, edges 0 (1-2), 1 (2-0), 2 (0-1) as neighbours have them, dominant corners
            [0, 1, 2, 4, 6, 2, 0, 0, 1, 0, 1, 2],
            [4, 5, 6, 5, 6, 2, 1, 4, 5, 1, 5, 2],
        ],
    )
    assert adjacency.edges[0, 0] == adjacency.edges[1, 1]
    assert len(adjacency.sides) == 5
    np.testing.assert_array_equal(
        adjacency.sides[adjacency.edges[0, 0]], [0, 4]
    )  # edge 0 of triangle 0, edge 1 of triangle 1
    np.testing.assert_array_equal(
        adjacency.without_neighbours().patches[0, 3:9], [1, 2, 2, 0, 0, 1]
    )


@pytest.mark.parametrize("make", CLOSED.values(), ids=CLOSED)
def test_every_edge_of_a_closed_mesh_has_two_sides(make) -> None:
    adjacency = Adjacency.of(make())
    assert (adjacency.sides[:, 0] != adjacency.sides[:, 1]).all()
    assert 2 * len(adjacency.sides) == adjacency.edges.size
