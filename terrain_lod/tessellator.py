"""The fixed-function tessellator of Direct3D 11, on the device.

Factors in, points and triangles of the domain out: it sees no positions and no heights. Results
agree with Microsoft's reference tessellator to the bit, on any device.

>>> import terrain_lod as tl
>>> pattern = tl.tessellate("quad", [[3, 5, 7.5, 9]], [[4.2, 6]])
>>> pattern
Pattern(quad, fractional_odd: 1 patches, 62 points, 96 triangles, 0 lines)
"""

from __future__ import annotations

from typing import Final, NamedTuple

from .device import Device, DeviceArray
from .errors import InputError
from .layout import PARTITIONINGS
from .pattern import DevicePattern
from .scan import exclusive_scan

_LARGEST_INDEX_COUNT: Final = 2**31
_ITEMS: Final = (16, 4)  # columns and rows of work-items that fill a patch, on a GPU


class Domain(NamedTuple):
    """Factors of a patch, and corners of a primitive."""

    edges: int
    insides: int
    corners: int


DOMAINS: Final = {"quad": Domain(4, 2, 3), "triangle": Domain(3, 1, 3), "isoline": Domain(2, 0, 2)}


def tessellate_device(
    domain: str,
    edge_factors: DeviceArray,
    inside_factors: DeviceArray | None,
    partitioning: str,
    *,
    clockwise: bool,
) -> DevicePattern:
    """Tessellate patches whose factors are on the device, and leave the pattern there.

    Parameters
    ----------
    domain : str
        A key of :data:`DOMAINS`.
    edge_factors : DeviceArray, (P, edges) float32
    inside_factors : DeviceArray, (P, insides) float32, or None
        None where the domain has none.
    partitioning : str
    clockwise : bool
        Winding of the triangles, seen with u to the right and v down.

    Raises
    ------
    InputError
        If there would be more than 2³¹ indices.
    DeviceMemoryError
        If points and primitives do not fit the device. Neither is allocated then.
    """
    device, patches = edge_factors.device, edge_factors.shape[0]
    factors = {"edge_factors": edge_factors, "partitioning": PARTITIONINGS.index(partitioning)}
    if inside_factors is not None:
        factors["inside_factors"] = inside_factors
    # how many
    point_counts, primitive_counts = (device.empty(patches, "uint32") for _ in range(2))
    device.kernel("tessellator.cl", f"{domain}_count")(
        (patches,),
        (device.group_size(),),
        patches=patches,
        point_counts=point_counts,
        primitive_counts=primitive_counts,
        **factors,
    )
    # where to
    point_offsets, point_count = exclusive_scan(point_counts)
    primitive_offsets, primitive_count = exclusive_scan(primitive_counts)
    points, primitives = _output(device, domain, patches, point_count, primitive_count)
    # which
    items = _ITEMS if device.is_gpu else (1, 1)
    device.kernel("tessellator.cl", f"{domain}_fill")(
        (patches * items[0], items[1]),
        items,
        point_offsets=point_offsets,
        primitive_offsets=primitive_offsets,
        points=points,
        primitives=primitives,
        **({"clockwise": clockwise} if DOMAINS[domain].corners == 3 else {}),
        **factors,
    )
    return DevicePattern(points, primitives, point_offsets, primitive_offsets)


def _output(
    device: Device, domain: str, patches: int, point_count: int, primitive_count: int
) -> tuple[DeviceArray, DeviceArray]:
    """Return room for the points and the primitives, or refuse before taking any."""
    corners = DOMAINS[domain].corners
    index_count = corners * primitive_count
    if index_count > _LARGEST_INDEX_COUNT:
        raise InputError(
            f"expected at most {_LARGEST_INDEX_COUNT} indices, got {index_count} of {patches} "
            "patches: use smaller factors or fewer patches at a time"
        )
    what = f"a pattern of {point_count} points and {index_count} indices"
    device.require(what, 8 * point_count, 4 * index_count)
    return (
        device.empty((point_count, 2), "uint32"),
        device.empty((primitive_count, corners), "int32"),
    )
