"""Checks of the kernels of Bézier patches, parametric surfaces and curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..curved.bezier import bezier, bezier_mesh
from ..curved.bezier_curves import bezier_curve
from ..curved.catmull_clark import catmull_clark_patches
from ..curved.control_mesh import ControlMesh
from ..curved.curves import CURVES, curve
from ..curved.surfaces import SURFACES, ParametricSurface, surface
from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..numbered import defaults_of
from ..reference.curved import bezier as bezier_reference
from ..reference.curved import surfaces as reference
from ..tessellation.tessellator import tessellate
from .check import Array, Bound, Check, Difference, highest_of

_PLACES: Final = Bound(
    "points of patches and curves",
    "units",
    "2e-6 of the largest coordinate",
    "sines to 4 ulp, and a dozen products of numbers of that size",
)
_NORMALS: Final = Bound(
    "their normals",
    "of length 1",
    "1e-4",
    "a cross product of derivatives, one of which near a collapsed edge is a hundredth of others; "
    "those of a surface's reference are differences of its positions",
)
_TANGENTS: Final = Bound(
    "their tangents", "of length 1", "1e-5", "a derivative of sines, made of length 1"
)


def _bezier(nets: Array, device: Device) -> Iterator[Difference]:
    found = bezier(nets, factor=6.3, device=device)
    factors = (np.full((len(nets), width), 6.3) for width in (4, 2))
    pattern = tessellate("quad", *factors, device=device)
    patch = np.repeat(np.arange(len(nets)), np.diff(pattern.point_offsets))
    u, v = pattern.points.T / FIXED_ONE
    positions, normals = bezier_reference.bezier(nets[patch].astype(np.float64), u, v)
    yield _PLACES.met_by(found.vertices, positions, 2e-6 * highest_of(positions))
    yield _NORMALS.met_by(found.normals, normals, 1e-4)


def _bezier_curve(degree: int, device: Device) -> Iterator[Difference]:
    points = np.random.default_rng(degree).normal(size=(5, degree + 1, 3)).astype(np.float32)
    found = bezier_curve(points, factor=8, partitioning="integer", device=device)
    pieces, t = np.repeat(np.arange(5), 9), np.tile(np.arange(9) / 8, 5)
    at, along = bezier_reference.curve_of_any_degree(points[pieces].astype(np.float64), t)
    yield _PLACES.met_by(found.points, at, 4e-6 * highest_of(at))
    yield _NORMALS.met_by(found.tangents, along, 1e-4)


BEZIER_CURVE: Final = Check(
    _bezier_curve,
    lambda: {"degree 3": 3},
    lambda: {f"degree {degree}": degree for degree in (1, 2, 7, 32)},
)


def _with_tangents(mesh: ControlMesh, device: Device) -> Iterator[Difference]:
    """Compare patches whose normals come from fields of tangents."""
    patches = catmull_clark_patches(mesh)
    nets, *fields = (
        each.astype(np.float32) for each in (patches.nets, patches.along_u, patches.along_v)
    )
    edges, insides = (np.full((len(nets), width), 6.3, np.float32) for width in (4, 2))
    found = bezier_mesh(nets, (edges, insides), "fractional_odd", device, fields)
    pattern = tessellate("quad", edges, insides, device=device)
    patch = np.repeat(np.arange(len(nets)), np.diff(pattern.point_offsets))
    u, v = pattern.points.T / FIXED_ONE
    positions = bezier_reference.field(nets[patch].astype(np.float64), u, v)
    along_u, along_v = (
        bezier_reference.field(each[patch].astype(np.float64), u, v) for each in fields
    )
    normals = np.cross(along_u, along_v)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    known = lengths[:, 0] > 1e-3 * lengths.max()
    yield _PLACES.met_by(found.vertices, positions, 2e-6 * highest_of(positions))
    yield _NORMALS.met_by(found.normals[known], (normals / lengths)[known], 1e-4)


def _prism(sides: int) -> ControlMesh:
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles), np.ones(sides)], axis=1)
    walls = [(i, i + sides, (i + 1) % sides + sides, (i + 1) % sides) for i in range(sides)]
    lids = [tuple(range(sides)), tuple(range(2 * sides - 1, sides - 1, -1))]
    return ControlMesh(np.concatenate([ring, ring * (1, 1, -1)]), [*lids, *walls])


TANGENTS: Final = Check(
    _with_tangents,
    lambda: {"prism of 5 sides": _prism(5)},
    lambda: {f"prism of {sides} sides": _prism(sides) for sides in (3, 8, 30)},
)


def _nets() -> Array:
    nets = np.random.default_rng(7).normal(size=(6, 4, 4, 3)).astype(np.float32)
    nets[..., 0] += np.arange(0, 40, 10)[:, None]
    nets[..., 1] += np.arange(0, 40, 10)
    nets[0, :, 0] = nets[0, 0, 0]  # an edge in one point
    return nets


BEZIER: Final = Check(
    _bezier,
    lambda: {"rough patches": _nets()},
    lambda: {f"patches times {scale:g}": _nets() * np.float32(scale) for scale in (1e-12, 1e15)},
)


@dataclass(frozen=True)
class Shape:
    """A surface or a curve of the tables, and numbers other than its own."""

    name: str
    numbers: dict[str, Any]


def _surface(case: Shape, device: Device) -> Iterator[Difference]:
    shape, formula = SURFACES[case.name], reference.SURFACES[case.name]
    smooth = _inside_octants if case.name == "superquadric" else _everywhere
    return _on_surface(shape, formula, case.numbers, smooth, device)


def _everywhere(u: Array, v: Array) -> Array:
    return np.ones(u.shape, bool)


def _inside_octants(u: Array, v: Array) -> Array:
    """Return where differences say something though a power below 1 leaves flat points or edges."""
    near_u, near_v = (np.abs(each - np.rint(each)) for each in (4 * u, 2 * v))
    inside: Array = (near_u > 0.01) & (near_v > 0.01)
    return inside


def _on_surface(
    shape: ParametricSurface,
    formula: reference.Formula,
    numbers: dict[str, Any],
    smooth: Callable[[Array, Array], Array],
    device: Device,
) -> Iterator[Difference]:
    """Compare positions, and normals where the surface is `smooth` at u and v; not at poles."""
    (across, down), factor = (5, 3), 6.3
    factors = (np.full((across * down, width), factor) for width in (4, 2))
    pattern = tessellate("quad", *factors, device=device)
    patch = np.repeat(np.arange(across * down), np.diff(pattern.point_offsets))
    own_u, own_v = pattern.points.T / FIXED_ONE
    u, v = (patch % across + own_u) / across, (patch // across + own_v) / down
    found = surface(shape, patches=(across, down), factor=factor, device=device, **numbers)
    positions, normals = reference.surface(formula, u, v, defaults_of(shape.numbers) | numbers)
    compared = smooth(u, v) & ~np.isnan(normals).any(axis=1)
    yield _PLACES.met_by(found.vertices, positions, 2e-6 * highest_of(positions))
    yield _NORMALS.met_by(found.normals[compared], normals[compared], 1e-4)


def check_shape(
    shape: ParametricSurface,
    formula: reference.Formula,
    normals: bool = True,
    *,
    device: Device | None = None,
) -> Difference:
    """Compare what a surface's header computes with its reference, over all of it.

    Parameters
    ----------
    shape : ParametricSurface
        All its numbers have defaults.
    formula : callable
        ``(u, v, numbers) -> x, y, z`` in float64, u and v from 0 to 1 and a little beyond.
    normals : bool, optional
        Compare normals as well, with the reference's differences; poles are left out.
    device : Device, optional

    Returns
    -------
    Difference
        Of a position, in the surface's unit of length, or of a normal, where it is most of what
        rounding allows.
    """

    def smooth(u: Array, v: Array) -> Array:
        return np.full(u.shape, normals)

    def compare(case: ParametricSurface, device: Device) -> Iterator[Difference]:
        return _on_surface(case, formula, {}, smooth, device)

    return Check(compare, lambda: {"the shape": shape}).worst(Device.of(device))


def _curve(case: Shape, device: Device) -> Iterator[Difference]:
    pieces, factor = 6, 20
    common: dict[str, Any] = {"partitioning": "integer", "device": device}
    found = curve(case.name, pieces=pieces, factor=factor, **common, **case.numbers)
    lines = tessellate("isoline", [[1, factor]], **common)
    along = lines.points[:, 0] / FIXED_ONE
    t = [*((piece + place) / pieces for piece in range(pieces) for place in along[:-1]), 1.0]
    numbers = defaults_of(CURVES[case.name].numbers) | case.numbers
    positions, tangents = reference.curve(case.name, np.array(t), numbers)
    yield _PLACES.met_by(found.points, positions, 2e-6 * highest_of(positions))
    yield _TANGENTS.met_by(found.tangents, tangents, 1e-5)


def _shapes(table: Any) -> dict[str, Shape]:
    return {name: Shape(name, {}) for name in table}


def _others(table: Any) -> dict[str, Shape]:
    """Return every shape of a table with other numbers, some of them small or far apart."""
    return {
        f"{name}, other numbers": Shape(name, numbers)
        for name, numbers in _OTHER_NUMBERS.items()
        if name in table
    }


_OTHER_NUMBERS: Final[dict[str, dict[str, Any]]] = {
    "sphere": {"radius": 3.5},
    "torus": {"radius": 2.0, "tube": 0.1},
    "moebius": {"radius": 5.0, "width": 1.0},
    "klein": {"radius": 3.0, "size": 0.5},
    "helicoid": {"radius": 0.5, "pitch": 3.0, "turns": 1.5},
    "seashell": {"turns": 2.5, "growth": 3.0, "tube": 0.3, "height": 0.0},
    "superquadric": {"radius": 2.0, "along": 1.0, "across": 1.5},
    "helix": {"radius": 0.2, "pitch": 2.0, "turns": 1.5},
    "torus_knot": {"radius": 3.0, "tube": 1.0, "p": 5, "q": 7},
    "lissajous": {"size": 2.0, "x": 1, "y": 1, "z": 2},
}

SURFACE: Final = Check(_surface, lambda: _shapes(SURFACES), lambda: _others(SURFACES))
CURVE: Final = Check(_curve, lambda: _shapes(CURVES), lambda: _others(CURVES))
