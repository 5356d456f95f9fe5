"""One check a kernel: what a device computes against the float64 reference, on small data.

A check uploads all that its kernel reads, so that another kernel's fault is not taken for its own,
and returns the worst difference. A new kernel's check is one function and one row here.
"""

from __future__ import annotations

from typing import Final

from . import amplify, displaced, pn, promise, queries, surfaces, terrain, tessellator
from .checkup import Checks

CHECKS: Final[Checks] = {
    # by the kernel's file, without its ending
    "terrain/analysis": terrain.check_analysis,
    "terrain/control_points": terrain.check_control_points,
    "terrain/hull": terrain.check_hull,
    "terrain/weights": promise.check_weights,
    "common/scan": tessellator.check_scan,
    "tessellation/tessellator": tessellator.check_tessellator,
    "tessellation/queues": surfaces.check_queues,
    "tessellation/semi_uniform": surfaces.check_semi_uniform,
    "curved/bezier": surfaces.check_bezier,
    "curved/surface": surfaces.check_surface,
    "curved/curve": surfaces.check_curve,
    "terrain/domain": terrain.check_domain,
    "terrain/holes": terrain.check_holes,
    "terrain/ladder": promise.check_ladder,
    "terrain/selection": promise.check_selection,
    "terrain/tile_error": promise.check_tile_error,
    "curved/pn_hull": pn.check_pn_hull,
    "curved/pn_edges": pn.check_pn_edges,
    "curved/pn_patches": pn.check_pn_patches,
    "curved/pn_domain": pn.check_pn_domain,
    "curved/pn_blend": pn.check_pn_blend,
    "curved/displaced": pn.check_displaced,
    "curved/decals": pn.check_decals,
    "curved/displaced_normals": displaced.check_displaced_normals,
    "curved/decal_reach": displaced.check_decal_reach,
    "curved/amplify": amplify.check_amplify,
    "measure/vertical_error": terrain.check_vertical_error,
    "terrain/queries": queries.check_queries_ground,
    "mesh/queries": queries.check_queries_mesh,
    "common/bandwidth": tessellator.check_bandwidth,
}
