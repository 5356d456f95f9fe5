"""Checks of the kernels of curved PN-triangles."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, cached_property
from typing import Final

import numpy as np

from ..camera.camera import Camera
from ..curved.adjacency import Adjacency
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
from ..device.layout import FIXED_ONE
from ..mesh.mesh import Mesh
from ..reference.curved import patch_culling, patch_factors, pn, pn_blend
from ..tessellation.semi_uniform import semi_uniform_device
from .check import Array, Bound, Check, Difference, highest_of, ulp
from .tessellation import points_alone


class Sheet:
    """A crumpled sheet whose vertices are half shared, half split, and its control points.

    Of `side` x `side` vertices, 4 times `scale` wide, `away` from the origin along every axis.
    """

    def __init__(self, side: int, scale: float = 1.0, away: float = 0.0) -> None:
        random = np.random.default_rng(6)
        row, column = (index.ravel() for index in np.indices((side, side)))
        flat = 4 * np.stack([column, row, np.zeros(side**2)], axis=1) / (side - 1) - 2
        sheet = (flat + random.normal(size=flat.shape) * 0.05) * scale + away
        corner = (row * side + column)[(row < side - 1) & (column < side - 1)]
        a, b, c, d = corner, corner + 1, corner + side, corner + side + 1
        triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
        # every other triangle has vertices of its own
        split = triangles[::2].ravel()
        vertices = np.concatenate([sheet, sheet[split]]).astype(np.float32)
        triangles[::2] = len(sheet) + np.arange(len(split)).reshape(-1, 3)
        normals = random.normal(size=vertices.shape) * 0.2 + (0, 0, 1)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        self.mesh = Mesh(vertices, normals.astype(np.float32), triangles.astype(np.int32))
        self.adjacency = Adjacency.of(self.mesh)
        self.scale, self.largest = scale, highest_of(vertices)
        wide = vertices.astype(np.float64), self.mesh.normals.astype(np.float64)
        self.controls = pn.control_points(self.adjacency.patches, *wide)
        self.control_normals = pn.control_normals(self.adjacency.patches, *wide)
        self.surface = (*wide, self.controls)
        # from above, and from below, where patches are turned away
        self.view, self.view_below = (
            Camera(
                tuple(np.array(eye) * scale + away),
                (away, away, away),
                fov=50,
                size=(320, 200),
                near=0.1 * scale,
            ).view((0, 0, 0))
            for eye in ((-1.0, -3.0, 0.8), (-0.3, -0.3, -5.0))
        )

    @cached_property
    def edges(self) -> list[patch_factors.Edge]:
        """What formulas are given."""
        return [
            patch_factors.edge_of(self.mesh.triangles, self.adjacency.patches, sides, *self.surface)
            for sides in self.adjacency.sides
        ]

    def upload(self, device: Device) -> DevicePatchMesh:
        return DevicePatchMesh.upload(self.mesh.vertices, self.mesh.normals, self.adjacency, device)

    @property
    def nets(self) -> Array:
        """What the hull should have found; (T, 16, 3) float32."""
        first, second = [1, 2, 2, 0, 0, 1], [2, 1, 0, 2, 1, 0]
        straight = (2 * self.controls[:, first] + self.controls[:, second]) / 3
        lifts = 3 * (self.controls[:, 3:9] - straight)
        middle = 6 * (self.controls[:, 9] - self.controls[:, :3].mean(axis=1))
        parts = (self.controls[:, :3], lifts, middle[:, None], self.control_normals)
        return np.concatenate(parts, axis=1).astype(np.float32)


@cache
def sheets() -> dict[str, Sheet]:
    """Return an ordinary mesh."""
    return {"crumpled sheet": Sheet(8)}


@cache
def scaled_sheets() -> dict[str, Sheet]:
    """Return meshes of other sizes."""
    return {f"sheet times {scale:g}": Sheet(6, scale) for scale in (1e-6, 1e6)}


@cache
def hard_sheets() -> dict[str, Sheet]:
    """Return these and one far from its origin; no camera in 32 bits stands well beside it."""
    return scaled_sheets() | {"sheet of 0.04, 1,000 away": Sheet(6, 0.01, 1000.0)}


_POSITION: Final = Bound(
    "curved position",
    "units",
    "4 ulp of the largest coordinate",
    "straight parts are exact differences of corners, lifts off them are small",
)
_NETS: Final = Bound(
    "control vectors",
    "units",
    "4 ulp of the largest coordinate",
    "a lift is a product of a difference and a unit normal, each rounded",
)
_NORMALS: Final = Bound(
    "curved normal",
    "of length 1",
    "2e-5",
    "the weakest of the random blends are sums of vectors that all but cancel",
)


def _hull(case: Sheet, device: Device) -> Iterator[Difference]:
    found, expected = nets_on_device(case.upload(device)).host(), case.nets
    yield _NETS.met_by(found[:, :10], expected[:, :10], 4 * ulp(case.largest))
    yield _NORMALS.met_by(found[:, 10:], expected[:, 10:], 2e-5)


HULL: Final = Check(_hull, sheets, hard_sheets)


def _domain(case: Sheet, device: Device) -> Iterator[Difference]:
    random = np.random.default_rng(7)
    count, patches = 20, len(case.mesh.triangles)
    u = random.integers(0, FIXED_ONE + 1, patches * count)
    v = random.integers(0, FIXED_ONE + 1 - u)
    patch = np.repeat(np.arange(patches), count)
    pattern = points_alone(np.stack([u, v], axis=1), patches, device)
    weights = np.stack([u, v, FIXED_ONE - u - v], axis=1) / FIXED_ONE
    found = evaluate_on_device(device.array(case.nets), pattern)
    positions = pn.positions_at(case.controls[patch], weights)
    normals = pn.normals_at(case.control_normals[patch], case.controls[patch, :3], weights)
    yield _POSITION.met_by(found.positions.host(), positions, 4 * ulp(case.largest))
    yield _NORMALS.met_by(found.normals.host(), normals, 2e-5)


DOMAIN: Final = Check(_domain, sheets, hard_sheets)

_SEGMENTS: Final = Bound(
    "factors of edges",
    "segments",
    "1e-3",
    "a curve's length in the picture, of a chain of chords that are each rounded",
)


def _formulas(scale: float) -> tuple[EdgeFactor, ...]:
    return (
        UniformFactor(5.5),
        DistanceFactor(near=1.0 * scale, far=9.0 * scale),
        LengthFactor(pixels=10.0),
        OrientationFactor(),
        SilhouetteFactor(),
        CurvatureFactor(),
    )


def _edges(case: Sheet, device: Device) -> Iterator[Difference]:
    for formula in _formulas(case.scale):
        yield _factors(case, device, formula, patch_factors.FORMULAS[formula.header])


def _factors(
    case: Sheet, device: Device, formula: EdgeFactor, reference: patch_factors.Formula
) -> Difference:
    diagonal, view = 5.0 * case.scale, case.view
    found = edge_factors_on_device(case.upload(device), formula, diagonal, view).host()
    parameters = formula.parameters(diagonal)
    return _SEGMENTS.met_by(found, [reference(e, view, parameters) for e in case.edges], 1e-3)


EDGES: Final = Check(_edges, sheets, scaled_sheets)


def check_factor(
    formula: EdgeFactor,
    reference: patch_factors.Formula | None = None,
    *,
    device: Device | None = None,
) -> Difference:
    """Compare what a formula's header computes with its reference, on a crumpled sheet.

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
    Difference
        Of a factor, in segments, where it is most of what rounding allows.

    Raises
    ------
    InputError
        If `formula` is none for edges.
    """
    header = checked_formula(formula).header
    expected = reference or patch_factors.FORMULAS[header]

    def compare(case: Sheet, device: Device) -> Iterator[Difference]:
        yield _factors(case, device, formula, expected)

    return Check(compare, sheets).worst(Device.of(device))


_CULLED: Final = Bound(
    "patches culled or kept",
    "patches",
    "exact, but for those within 1e-4 of being seen",
    "an angle or a depth of a dozen roundings decides",
)


def _patches(case: Sheet, device: Device) -> Iterator[Difference]:
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
        decided = (np.abs(back) > 1e-4) & (np.abs(depth) > 1e-4 * case.scale)
        yield _CULLED.met_by(np.count_nonzero(unlike & decided), 0)


PATCHES: Final = Check(_patches, sheets, scaled_sheets)

_SLIDING: Final = Bound(
    "blended position",
    "units",
    "1e-5 of the sheet, and 4 ulp of the largest coordinate",
    "points slide along edges by steps of 2^-16",
)


def _blend(case: Sheet, device: Device) -> Iterator[Difference]:
    random = np.random.default_rng(12)
    factors = random.uniform(1, 16, len(case.adjacency.sides))[case.adjacency.edges]
    levels = levels_on_device(device.array(factors.astype(np.float32)), maximum=4)
    nets = device.array(case.nets)
    pattern = semi_uniform_device(
        levels, maximum=4, keep_degenerate=True, clockwise=True, turns=turns_on_device(nets)
    )
    found = blend_on_device(nets, levels, pattern).positions.host()
    offsets, points = pattern.point_offsets.host().astype(int), pattern.points.host() / FIXED_ONE
    wanted, places, expected = np.log2(factors), [], []
    for patch in range(0, len(case.mesh.triangles), 12):
        for place in range(offsets[patch], offsets[patch + 1]):
            u, v = points[place].tolist()
            weights = u, v, 1 - u - v
            places.append(place)
            expected.append(pn_blend.blended_position(case.controls[patch], wanted[patch], weights))
    yield _SLIDING.met_by(found[places], expected, 1e-5 * case.scale + 4 * ulp(case.largest))


BLEND: Final = Check(_blend, sheets, hard_sheets)
