"""Many triangles of one in float64: what ``ways.cl`` computes, by walking the rings."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from terrain_lod.device.layout import FIXED_ONE
from terrain_lod.reference.curved import pn
from terrain_lod.reference.tessellation import tessellator

Array = npt.NDArray[np.float64]


def rows(level: int) -> Iterator[tuple[int, int, list[int], list[int]]]:
    """Yield each strip's ring, side, and points along its outer and inner rows."""
    first = 0
    for ring in range((level - 1) // 2):
        steps = level - 2 * ring
        inner_first = first + 3 * steps
        outer_loop = [*range(first, inner_first), first]
        inner_loop = [*range(inner_first, inner_first + 3 * (steps - 2)), inner_first]
        for side in range(3):
            outer = outer_loop[side * steps : (side + 1) * steps + 1]
            inner = inner_loop[side * (steps - 2) : (side + 1) * (steps - 2) + 1]
            yield ring, side, outer, inner
        first = inner_first


def triangles(level: int) -> list[tuple[int, int, int]]:
    """Return the sub-triangles of a patch: strip by strip, then the one in the middle."""
    made = []
    for _, _, outer, inner in rows(level):
        half = len(inner) // 2
        # outer and inner in turn; half-way the order is mirrored
        o = i = 0
        for row in "oi" * half + "o" + "o" + "io" * (half - 1):
            if row == "o":
                made.append((outer[o], outer[o + 1], inner[i]))
                o += 1
            else:
                made.append((inner[i], outer[o], inner[i + 1]))
                i += 1
    rings = (level - 1) // 2
    middle = 3 * rings * (level - rings + 1)
    return [*made, (middle, middle + 1, middle + 2)]


def emitters(level: int, *, quads: bool) -> list[tuple[int, int, int]]:
    """Return ring, side and first triangle of a patch's emitters, the middle one's last."""
    records = []
    for ring, side, outer, inner in rows(level):
        strip = len(outer) + len(inner) - 2
        records += [(ring, side, first) for first in range(0, strip, 2 if quads else strip)]
    return [*records, ((level - 1) // 2, 0, 0)]


def sub_triangles(
    patches: npt.NDArray[np.int32], positions: Array, normals: Array, level: int
) -> tuple[Array, Array]:
    """Return positions and normals of the corners of T patches' sub-triangles; (T, S, 3, 3) each.

    Parameters
    ----------
    patches : (T, 12) int32
        See :class:`terrain_lod.curved.adjacency.Adjacency`.
    positions, normals : (V, 3)
    level : int
        Odd.
    """
    pattern = tessellator.tessellate("triangle", [[level] * 3], [[level]])
    uv = pattern.points / FIXED_ONE
    weights = np.concatenate([uv, 1 - uv.sum(axis=1, keepdims=True)], axis=1)
    controls = pn.control_points(patches, positions, normals)
    control_normals = pn.control_normals(patches, positions, normals)
    each = np.repeat(np.arange(len(patches)), len(weights))
    weights = np.tile(weights, (len(patches), 1))
    shape = len(patches), -1, 3
    found = pn.positions_at(controls[each], weights).reshape(shape)
    turned = pn.normals_at(control_normals[each], controls[each, :3], weights).reshape(shape)
    corners = np.array(triangles(level))
    return found[:, corners], turned[:, corners]
