"""Checks of the kernels of curved PN-triangles, see :mod:`terrain_lod.checks.table`."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..curved.adjacency import Adjacency
from ..curved.decals import dent_on_device
from ..curved.displaced import displace_on_device, dominant_edges, shared_normals
from ..curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    EdgeFactor,
    LengthFactor,
    OrientationFactor,
    SilhouetteFactor,
    UniformFactor,
    checked_formula,
)
from ..curved.patched_mesh import PatchedMesh
from ..curved.pn import (
    DevicePatchMesh,
    blend_on_device,
    edge_factors_on_device,
    evaluate_on_device,
    levels_on_device,
    nets_on_device,
    patch_factors_on_device,
    turns_on_device,
)
from ..device.device import Device
from ..device.layout import DECAL, FIXED_ONE
from ..mesh.mesh import Mesh
from ..reference.curved import (
    displaced,
    patch_culling,
    patch_factors,
    pn,
    pn_blend,
)
from ..tessellation.pattern import DevicePattern
from ..tessellation.semi_uniform import semi_uniform_device
from .checkup import Check, largest_difference

Array = npt.NDArray[Any]

# of coordinates up to 4: four times their last place
_POSITIONS: Final = 2e-6
# points slide along edges by steps of 1/65536
_SLIDING: Final = 1e-5
# of the weakest of the random blends of normals
_NORMALS: Final = 2e-5
_SEGMENTS: Final = 1e-3
# a patch nearer to being seen, or not, than this may go either way
_DECIDED: Final = 1e-4

_FORMULAS: Final[tuple[EdgeFactor, ...]] = (
    UniformFactor(5.5),
    DistanceFactor(near=1.0, far=9.0),
    LengthFactor(pixels=10.0),
    OrientationFactor(),
    SilhouetteFactor(),
    CurvatureFactor(),
)


class _Case:
    """Two crumpled sheets whose vertices are half shared, half split, and what is expected."""

    def __init__(self) -> None:
        random = np.random.default_rng(6)
        side = 12
        row, column = (index.ravel() for index in np.indices((side, side)))
        sheet = np.stack([column, row, np.zeros(side**2)], axis=1) / 3 - 2
        sheet = sheet + random.normal(size=sheet.shape) * 0.05
        corner = (row * side + column)[(row < side - 1) & (column < side - 1)]
        a, b, c, d = corner, corner + 1, corner + side, corner + side + 1
        triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
        # every other triangle has vertices of its own
        split = triangles[::2].ravel()
        self.vertices = np.concatenate([sheet, sheet[split]]).astype(np.float32)
        triangles[::2] = len(sheet) + np.arange(len(split)).reshape(-1, 3)
        normals = random.normal(size=self.vertices.shape) * 0.2 + (0, 0, 1)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        self.normals = normals.astype(np.float32)
        self.triangles = triangles.astype(np.int32)
        self.adjacency = Adjacency.of(Mesh(self.vertices, self.normals, self.triangles))
        wide = self.vertices.astype(np.float64), self.normals.astype(np.float64)
        self.positions64, self.normals64 = wide
        self.controls = pn.control_points(self.adjacency.patches, *wide)
        self.control_normals = pn.control_normals(self.adjacency.patches, *wide)
        # from above, and from below, where patches are turned away
        self.view, self.view_below = (
            Camera(eye, (0, 0, 0), fov=50, size=(320, 200)).view((0, 0, 0))
            for eye in ((-1.0, -3.0, 0.8), (-0.3, -0.3, -5.0))
        )

    def upload(self, device: Device) -> DevicePatchMesh:
        return DevicePatchMesh.upload(self.vertices, self.normals, self.adjacency, device)

    @property
    def nets(self) -> Array:
        """What the hull should have found; (T, 16, 3) float32."""
        first, second = [1, 2, 2, 0, 0, 1], [2, 1, 0, 2, 1, 0]
        straight = (2 * self.controls[:, first] + self.controls[:, second]) / 3
        lifts = 3 * (self.controls[:, 3:9] - straight)
        middle = 6 * (self.controls[:, 9] - self.controls[:, :3].mean(axis=1))
        parts = (self.controls[:, :3], lifts, middle[:, None], self.control_normals)
        nets: Array = np.concatenate(parts, axis=1).astype(np.float32)
        return nets


@cache
def _case() -> _Case:
    return _Case()


def check_pn_hull(device: Device) -> Check:
    """Return the worst difference of a control vector."""
    found = nets_on_device(_case().upload(device)).host()
    return Check(float(np.abs(found - _case().nets).max()), _POSITIONS, "units")


def check_pn_domain(device: Device) -> Check:
    """Return the worst difference of positions and normals, in tolerances."""
    case, random = _case(), np.random.default_rng(7)
    count, patches = 20, len(case.triangles)
    u = random.integers(0, FIXED_ONE + 1, patches * count)
    v = random.integers(0, FIXED_ONE + 1 - u)
    patch = np.repeat(np.arange(patches), count)
    none = device.zeros((0, 3), np.int32)
    pattern = DevicePattern(
        device.array(np.stack([u, v], axis=1).astype(np.uint32)),
        none,
        device.array(np.arange(0, len(u) + 1, count, dtype=np.uint32)),
        none,
    )
    weights = np.stack([u, v, FIXED_ONE - u - v], axis=1) / FIXED_ONE
    found = evaluate_on_device(device.array(case.nets), pattern)
    positions = pn.positions_at(case.controls[patch], weights)
    normals = pn.normals_at(case.control_normals[patch], case.controls[patch, :3], weights)
    worst = max(
        np.abs(found.positions.host() - positions).max() / _POSITIONS,
        np.abs(found.normals.host() - normals).max() / _NORMALS,
    )
    return Check(float(worst), 1.0, "of the tolerance")


def check_pn_edges(device: Device) -> Check:
    """Return the worst difference of a factor, over all formulas."""
    worst = max(check_factor(formula, device=device).error for formula in _FORMULAS)
    return Check(worst, _SEGMENTS, "segments")


def check_factor(
    formula: EdgeFactor,
    reference: patch_factors.Formula | None = None,
    *,
    device: Device | None = None,
) -> Check:
    """Compare what a formula's header computes with its reference, on crumpled sheets.

    Parameters
    ----------
    formula : EdgeFactor
    reference : callable, optional
        ``(edge, view, parameters) -> segments`` in float64: see
        :class:`terrain_lod.reference.curved.patch_factors.Edge`. Default: that of a header of
        ``kernels/``.
    device : Device, optional

    Returns
    -------
    Check
        ``error`` is the worst difference of a factor, in segments; ``bound`` what rounding allows.

    Raises
    ------
    InputError
        If `formula` is none for edges.
    """
    checked_formula(formula)
    case, diagonal, device = _case(), 5.0, device or Device.open()
    corners, surface = case.triangles, (case.positions64, case.normals64, case.controls)
    edges = [
        patch_factors.edge_of(corners, case.adjacency.patches, places, *surface)
        for places in case.adjacency.sides
    ]
    found = edge_factors_on_device(case.upload(device), formula, diagonal, case.view).host()
    reference = reference or patch_factors.FORMULAS[formula.header]
    parameters = formula.parameters(diagonal)
    expected = [reference(edge, case.view, parameters) for edge in edges]
    worst = largest_difference(found, np.array(expected, np.float64))
    return Check(worst, _SEGMENTS, "segments")


def check_pn_patches(device: Device) -> Check:
    """Return how many patches are culled, or kept, that should not be; a hair's breadth may be."""
    case, wrong = _case(), 0
    factors = np.random.default_rng(8).uniform(1, 9, len(case.adjacency.sides)).astype(np.float32)
    mesh, nets, of_edges = case.upload(device), device.array(case.nets), device.array(factors)
    for view in (case.view, case.view_below):
        found = patch_factors_on_device(mesh, nets, of_edges, view, cull=True, back_cosine=0.0)
        back = np.array([patch_culling.back_cosine_of(one, view) for one in case.controls])
        depth = np.array([patch_culling.frustum_depth(one, view) for one in case.controls])
        culled = (back > 0) | (depth < 0)
        expected = np.where(culled[:, None], 0, factors[case.adjacency.edges])
        unlike = (found.edge.host() != expected).any(axis=1)
        unlike |= found.inside.host()[:, 0] != expected.max(axis=1)
        wrong += int(
            np.count_nonzero(unlike & (np.abs(back) > _DECIDED) & (np.abs(depth) > _DECIDED))
        )
    return Check(float(wrong), 0.0, "patches")


def check_displaced(device: Device) -> Check:
    """Return the worst difference of positions inside, on edges and at corners."""
    case, random = _case(), np.random.default_rng(9)
    patches = len(case.triangles)
    # inside, the three edges, the three corners
    third, half = FIXED_ONE // 3, FIXED_ONE // 2
    u = np.tile([third, 0, half, half, FIXED_ONE, 0, 0], patches)
    v = np.tile([third, half, 0, half, 0, FIXED_ONE, 0], patches)
    offsets = np.arange(0, len(u) + 1, 7, dtype=np.uint32)
    none = device.zeros((0, 3), np.int32)
    points = device.array(np.stack([u, v], axis=1).astype(np.uint32))
    pattern = DevicePattern(points, none, device.array(offsets), none)
    heights = random.uniform(size=(9, 7)).astype(np.float32)
    textures = random.uniform(-1, 2, (len(case.vertices), 2)).astype(np.float32)
    shared = shared_normals(case.vertices, case.normals)
    positions = device.zeros((len(u), 3), np.float32)
    mesh = Mesh(case.vertices, case.normals, case.triangles)
    base = PatchedMesh(mesh, case.adjacency, case.upload(device), device.array(case.nets))
    displace_on_device(base, heights, textures, pattern, positions, scale=0.5, bias=0.1)
    dominant, expected = dominant_edges(case.adjacency), np.empty((len(u), 3))
    surface = case.normals64, shared.astype(np.float64), textures.astype(np.float64)
    for i, (a, b) in enumerate(zip(u, v, strict=True)):
        weights = np.array([a, b, FIXED_ONE - a - b]) / FIXED_ONE
        patch = case.adjacency.patches[i // 7], dominant[i // 7]
        direction, (x, y) = displaced.displacement(*patch, *surface, weights)
        height = displaced.bilinear(heights, x % 1.0, y % 1.0, repeats=True)
        expected[i] = direction * (0.1 + 0.5 * height)
    return Check(float(np.abs(positions.host() - expected).max()), _POSITIONS, "units")


def check_decals(device: Device) -> Check:
    """Return the worst difference of positions under decals that overlap."""
    random = np.random.default_rng(10)
    positions = random.uniform(-1, 1, (500, 3)).astype(np.float32)
    depths = random.uniform(size=(6, 8)).astype(np.float32)
    records = np.zeros(5, DECAL)
    for record in records:
        normal = random.normal(size=3)
        tangent = np.cross(normal, random.normal(size=3))
        record["point"] = random.uniform(-1, 1, 3)
        record["normal"] = normal / np.linalg.norm(normal)
        record["tangent"] = tangent / np.linalg.norm(tangent)
        record["radius"], record["scale"], record["bias"] = 0.9, 0.3, 0.1
    moved = device.array(positions)
    dent_on_device(moved, records, depths)
    expected = [
        displaced.dented(position, records, depths) for position in positions.astype(np.float64)
    ]
    return Check(float(np.abs(moved.host() - np.array(expected)).max()), _POSITIONS, "units")


def check_pn_blend(device: Device) -> Check:
    """Return the worst difference of positions on patterns between whole levels."""
    case, random = _case(), np.random.default_rng(12)
    factors = random.uniform(1, 16, len(case.adjacency.sides))[case.adjacency.edges]
    levels = levels_on_device(device.array(factors.astype(np.float32)), maximum=4)
    nets = device.array(case.nets)
    pattern = semi_uniform_device(
        levels, maximum=4, keep_degenerate=True, clockwise=True, turns=turns_on_device(nets)
    )
    found = blend_on_device(nets, levels, pattern).positions.host()
    offsets, points = pattern.point_offsets.host().astype(int), pattern.points.host() / FIXED_ONE
    wanted, worst = np.log2(factors), 0.0
    for patch in range(0, len(case.triangles), 12):
        for place in range(offsets[patch], offsets[patch + 1]):
            u, v = points[place].tolist()
            weights = u, v, 1 - u - v
            expected = pn_blend.blended_position(case.controls[patch], wanted[patch], weights)
            worst = max(worst, float(np.abs(found[place] - expected).max()))
    return Check(worst, _SLIDING, "units")
