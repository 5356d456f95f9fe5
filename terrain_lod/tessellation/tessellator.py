"""The fixed-function tessellator of Direct3D 11: factors in, points and triangles of a domain out.

It sees no positions and no heights, and agrees with Microsoft's reference tessellator to the bit
on every device. What the factors mean is written in :mod:`terrain_lod.tessellation.factors`.
"""

from __future__ import annotations

from typing import Final

import numpy.typing as npt

from ..arguments import one_of
from ..device.device import Device, DeviceArray
from ..device.layout import PARTITIONINGS
from ..device.scan import exclusive_scans
from .factors import DOMAINS, checked_factors, counts
from .pattern import TOPOLOGIES, DevicePattern, Pattern
from .room import room_for_pattern

__all__ = ["TOPOLOGIES", "counts", "tessellate", "tessellate_device"]

_ITEMS: Final = (16, 4)  # columns and rows of work-items that fill a patch, on a GPU


def tessellate(
    domain: str,
    edge_factors: npt.ArrayLike,
    inside_factors: npt.ArrayLike | None = None,
    *,
    partitioning: str = "fractional_odd",
    topology: str = "clockwise",
    device: Device | None = None,
) -> Pattern:
    """Return the tessellation patterns of P patches.

    Parameters
    ----------
    domain : {"quad", "triangle", "isoline"}
    edge_factors : (P, 4), (P, 3) or (P, 2) array_like
        Of quads, triangles and isolines; used in float32.
    inside_factors : (P, 2) or (P, 1) array_like
        Of quads and triangles; isolines have none.
    partitioning : {"integer", "pow2", "fractional_odd", "fractional_even"}, optional
    topology : {"clockwise", "counter_clockwise"}, optional
        Winding of the triangles, seen with u to the right and v down.
    device : Device, optional

    Returns
    -------
    Pattern
        The boundary's points first, edge by edge: patches that share an edge, in whichever
        direction, and its factor have the same points on it. Degenerate triangles are kept.

    Raises
    ------
    InputError
        If a word is unknown, factors are too few or too many, or there would be more than 2³¹
        indices.
    DeviceMemoryError
        If the pattern does not fit the device.

    Examples
    --------
    >>> tessellate("quad", [[3, 5, 7.5, 9]], [[4.2, 6]])
    Pattern(quad, fractional_odd: 1 patches, 50 points, 72 triangles, 0 lines)
    """
    edges, insides = checked_factors(domain, edge_factors, inside_factors, partitioning)
    one_of("topology", topology, TOPOLOGIES)
    if len(edges) == 0:
        return Pattern.of_nothing(domain, partitioning, DOMAINS[domain].corners)
    device = Device.of(device)
    pattern = tessellate_device(
        domain,
        device.array(edges),
        None if insides is None else device.array(insides),
        partitioning,
        clockwise=topology == "clockwise",
    )
    return pattern.host(domain, partitioning)


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
    domain, partitioning : str
    edge_factors : DeviceArray, (P, edges) float32
    inside_factors : DeviceArray, (P, insides) float32, or None
        None where the domain has none.
    clockwise : bool
        Winding of the triangles, seen with u to the right and v down.

    Raises
    ------
    InputError, DeviceMemoryError
        If there would be too many indices or bytes; nothing of the pattern is allocated then.
    """
    device, patches = edge_factors.device, edge_factors.shape[0]
    factors: dict[str, object] = {
        "edge_factors": edge_factors,
        "partitioning": PARTITIONINGS.index(partitioning),
    }
    if inside_factors is not None:
        factors["inside_factors"] = inside_factors
    # how many
    point_counts, primitive_counts = (device.empty(patches, "uint32") for _ in range(2))
    device.kernel("tessellation/tessellator.cl", f"{domain}_count")(
        (patches,),
        (device.group_size(),),
        patches=patches,
        point_counts=point_counts,
        primitive_counts=primitive_counts,
        **factors,
    )
    # where to
    (point_offsets, point_count), (primitive_offsets, primitive_count) = exclusive_scans(
        point_counts, primitive_counts
    )
    corners = DOMAINS[domain].corners
    points, primitives = room_for_pattern(device, patches, point_count, primitive_count, corners)
    # which
    if corners == 3:
        factors["clockwise"] = clockwise
    items = _ITEMS if device.is_gpu else (1, 1)
    device.kernel("tessellation/tessellator.cl", f"{domain}_fill")(
        (patches * items[0], items[1]),
        items,
        point_offsets=point_offsets,
        primitive_offsets=primitive_offsets,
        points=points,
        primitives=primitives,
        **factors,
    )
    return DevicePattern(points, primitives, point_offsets, primitive_offsets)
