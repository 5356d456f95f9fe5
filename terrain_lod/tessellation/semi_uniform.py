"""Semi-uniform adaptive tessellation: dyadic lattices with snapped boundaries.

Another way than the Direct3D 11 tessellator to make patterns that meet without cracks, from whole
levels an edge: level n is 2ⁿ segments. A patch is tessellated as finely as its finest edge, and the
points on its coarser edges are moved onto those of the edge's level.

After Dyken, Reimers, Seland: *Semi-uniform adaptive patch tessellation*, Computer Graphics Forum
28(8), 2009, also of quads. ``kernels/tessellation/dyadic_edge.h`` says where points on coarser
edges go, as they have it and as it is here.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..arguments import array, flag, one_of, whole
from ..device.device import Device, DeviceArray
from ..device.layout import FIXED_BITS
from ..device.scan import exclusive_scans
from ..errors import InputError
from .factors import rows_of
from .pattern import TOPOLOGIES, DevicePattern, Pattern
from .queues import Queues, queues_of
from .room import room_for_pattern

LARGEST_LEVEL: Final = 10  # 1,048,576 triangles a patch, twice as many a quad
SNAPS: Final = {"nested": "snap", "nearest": "snap_to_nearest"}


class Lattice(NamedTuple):
    """The dyadic triangulation of a level, cut off from any patch.

    Its boundary, walked clockwise with u to the right and v down from u = 0, v = 1, has the first
    3 · 2ˡᵉᵛᵉˡ points, of a quad 4 · 2ˡᵉᵛᵉˡ; they follow from their number.
    """

    inside: npt.NDArray[np.uint32]  # (n, 2) the points inside, in 16.16
    triangles: npt.NDArray[np.int32]  # (4^level, 3) clockwise; of quads twice as many
    inner: int  # triangles that the boundary cannot collapse; they come first


def semi_uniform(
    levels: npt.ArrayLike,
    *,
    maximum: int = 5,
    snap: str = "nested",
    keep_degenerate: bool = True,
    topology: str = "clockwise",
    device: Device | None = None,
) -> Pattern:
    """Return semi-uniform tessellation patterns of P triangles or quads.

    Parameters
    ----------
    levels : (P, 3) or (P, 4) array_like
        Of the edges u = 0, v = 0, w = 0 of triangles, or u = 0, v = 0, u = 1, v = 1 of quads;
        fractions are rounded up. One below 0, or NaN, culls the patch.
    maximum : int, optional
        Largest level there may be, 0 to 10.
    snap : {"nested", "nearest"}, optional
        Where points on an edge of a lower level go: level by level to the neighbour that the next
        lower one has too, or to the nearest point, as the paper's equation 1 has it.
    keep_degenerate : bool, optional
        Whether triangles that a moved boundary collapses stay in the pattern, which then is the
        same for all patches of a level but for its points.
    topology : {"clockwise", "counter_clockwise"}, optional
        Winding of the triangles, seen with u to the right and v down.
    device : Device, optional

    Returns
    -------
    Pattern
        Of the triangle or the quad domain. A patch of level m, the largest of its edges', has the
        (2ᵐ + 1)(2ᵐ + 2) / 2 points of its lattice, or (2ᵐ + 1)², the boundary's first; those on an
        edge of level p stand on the 2ᵖ + 1 points of that level, some on the same.

    Raises
    ------
    InputError
        If levels are not three or four a patch or above `maximum`, `snap` is unknown, or there
        would be more than 2³¹ indices.
    DeviceMemoryError
        If the pattern does not fit the device.

    Examples
    --------
    >>> semi_uniform([[3, 1, 0]], keep_degenerate=False)
    Pattern(triangle, semi_uniform: 1 patches, 45 points, 51 triangles, 0 lines)
    """
    checked, maximum = _checked(levels, maximum)
    one_of("snap", snap, SNAPS)
    domain = "triangle" if checked.shape[1] == 3 else "quad"
    one_of("topology", topology, TOPOLOGIES)
    if len(checked) == 0:
        return Pattern.of_nothing(domain, "semi_uniform", corners=3)
    pattern = semi_uniform_device(
        Device.of(device).array(checked),
        maximum=maximum,
        keep_degenerate=flag("keep_degenerate", keep_degenerate),
        clockwise=topology == "clockwise",
        snap=snap,
    )
    return pattern.host(domain, "semi_uniform")


def semi_uniform_device(
    levels: DeviceArray,
    *,
    maximum: int,
    keep_degenerate: bool,
    clockwise: bool,
    turns: DeviceArray | None = None,
    snap: str = "nested",
) -> DevicePattern:
    """Tessellate triangles or quads by edge levels on the device, and leave the pattern there.

    Parameters
    ----------
    levels : DeviceArray, (P, 3) or (P, 4) float32
        Of the edges, see :func:`semi_uniform`: rounded up, and lowered to `maximum`.
    maximum : int
        0 to 10.
    keep_degenerate, clockwise : bool
    turns : DeviceArray, (P,) int32, optional
        A bit an edge: whether at level 0 its middle goes to the start of the walk, not to the end.
    snap : {"nested", "nearest"}, optional

    Raises
    ------
    InputError, DeviceMemoryError
        If there would be too many indices, or too many bytes; neither points nor triangles are
        allocated then.
    """
    device, (patches, sides) = levels.device, levels.shape
    group = device.group_size()
    built: dict[str, Any] = {"SIDES": sides, "SNAP": SNAPS[snap]}
    # how many
    patch_levels = device.empty(patches, np.int32)
    point_counts, triangle_counts = (device.empty(patches, np.uint32) for _ in range(2))
    common: dict[str, Any] = {
        "levels": levels,
        "maximum": maximum,
        "keep_degenerate": keep_degenerate,
    }
    device.kernel("tessellation/semi_uniform.cl", "semi_uniform_count", GROUP=group, **built)(
        (patches,),
        (group,),
        patches=patches,
        patch_levels=patch_levels,
        point_counts=point_counts,
        triangle_counts=triangle_counts,
        **common,
    )
    # where to
    (point_offsets, point_count), (triangle_offsets, triangle_count) = exclusive_scans(
        point_counts, triangle_counts
    )
    points, triangles = room_for_pattern(device, patches, point_count, triangle_count, 3)
    # which, a launch a level
    pattern = DevicePattern(points, triangles, point_offsets, triangle_offsets)
    queues = queues_of(patch_levels, maximum + 1)
    common["turns"] = device.zeros(patches, np.int32) if turns is None else turns
    for level in np.flatnonzero(np.diff(queues.begins)).tolist():
        _fill(pattern, queues, level, built, clockwise=clockwise, **common)
    return pattern


def _fill(
    pattern: DevicePattern, queues: Queues, level: int, built: dict[str, Any], **options: object
) -> None:
    """Fill in the patches of a level."""
    device, base = pattern.points.device, lattice(level, built["SIDES"])
    begin, end = queues.begins[level : level + 2].tolist()
    group = device.group_size()
    groups = device.runs(end - begin)
    device.kernel("tessellation/semi_uniform.cl", "semi_uniform_fill", GROUP=group, **built)(
        (groups * group,),
        (group,),
        level=level,
        queue_begin=begin,
        queue_end=end,
        inner_points=len(base.inside),
        inner_triangles=base.inner,
        queue=queues.members,
        lattice=device.array(base.inside),
        triangles=device.array(base.triangles),
        point_offsets=pattern.point_offsets,
        triangle_offsets=pattern.primitive_offsets,
        points=pattern.points,
        filled=pattern.primitives,
        **options,
    )


@cache
def lattice(level: int, sides: int = 3) -> Lattice:
    """Return the dyadic triangulation of `level`, which all its patches share."""
    steps = 2**level
    # number of every lattice point [i, j], u = i / steps, v = j / steps
    number = np.full((steps + 1, steps + 1), -1, np.int32)
    walk = np.arange(steps, dtype=np.int32)
    number[0, steps - walk] = walk
    number[walk, 0] = steps + walk
    if sides == 3:
        number[steps - walk, walk] = 2 * steps + walk
    else:
        number[steps, walk] = 2 * steps + walk
        number[steps - walk, steps] = 3 * steps + walk
    column, row = np.indices(number.shape)
    extent = steps if sides == 3 else 2 * steps  # of u + v
    i, j = np.nonzero((number < 0) & (column + row < extent))
    number[i, j] = sides * steps + np.arange(len(i), dtype=np.int32)
    inside = (np.stack([i, j], axis=1) << (FIXED_BITS - level)).astype(np.uint32)
    # cells of the lattice: the triangle at their corner, and the one that completes them
    i, j = np.nonzero((column < steps) & (row < steps) & (column + row < extent))
    low = np.stack([number[i, j], number[i + 1, j], number[i, j + 1]], axis=1)
    full = i + j < extent - 1
    i, j = i[full], j[full]
    high = np.stack([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]], axis=1)
    triangles = np.concatenate([low, high])
    at_rim = np.count_nonzero(triangles < sides * steps, axis=1) > 1
    ordered = np.concatenate([triangles[~at_rim], triangles[at_rim]])
    return Lattice(inside, ordered, len(triangles) - int(np.count_nonzero(at_rim)))


def _checked(levels: npt.ArrayLike, maximum: int) -> tuple[npt.NDArray[np.float32], int]:
    """Return levels, (P, 3) or (P, 4) float32, and the largest allowed, or say what is wrong."""
    maximum = whole("maximum", maximum, 0, LARGEST_LEVEL)
    quads = array("levels", levels, ("P", ...), None, is_finite=False).shape[1:] == (4,)
    rows = rows_of("levels", levels, 4 if quads else 3)
    if (rows > maximum).any():
        raise InputError(
            f"expected levels of at most maximum={maximum}, got {rows.max():g}: raise maximum, "
            f"up to {LARGEST_LEVEL}, or lower the levels"
        )
    return rows, maximum
