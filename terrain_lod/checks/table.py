"""One check a kernel: what a device computes against the float64 reference, on small data.

A check uploads all that its kernel reads, so that another kernel's fault is not taken for its own,
and returns the worst difference. A new kernel's check is one function and one row here.
"""

from __future__ import annotations

from typing import Final

from . import (
    amplify as checks_amplify,
)
from . import (
    displaced as checks_displaced,
)
from . import (
    pn as checks_pn,
)
from . import (
    promise as checks_promise,
)
from . import (
    queries as checks_queries,
)
from . import (
    surfaces as checks_surfaces,
)
from . import (
    terrain as checks_terrain,
)
from . import (
    tessellator as checks_tessellator,
)
from .checkup import Checks

CHECKS: Final[Checks] = {
    # by the stem of the kernel's file
    "analysis": checks_terrain.check_analysis,
    "control_points": checks_terrain.check_control_points,
    "hull": checks_terrain.check_hull,
    "weights": checks_promise.check_weights,
    "scan": checks_tessellator.check_scan,
    "tessellator": checks_tessellator.check_tessellator,
    "queues": checks_surfaces.check_queues,
    "semi_uniform": checks_surfaces.check_semi_uniform,
    "bezier": checks_surfaces.check_bezier,
    "surface": checks_surfaces.check_surface,
    "curve": checks_surfaces.check_curve,
    "domain": checks_terrain.check_domain,
    "holes": checks_terrain.check_holes,
    "ladder": checks_promise.check_ladder,
    "selection": checks_promise.check_selection,
    "tile_error": checks_promise.check_tile_error,
    "pn_hull": checks_pn.check_pn_hull,
    "pn_edges": checks_pn.check_pn_edges,
    "pn_patches": checks_pn.check_pn_patches,
    "pn_domain": checks_pn.check_pn_domain,
    "pn_blend": checks_pn.check_pn_blend,
    "displaced": checks_pn.check_displaced,
    "decals": checks_pn.check_decals,
    "displaced_normals": checks_displaced.check_displaced_normals,
    "decal_reach": checks_displaced.check_decal_reach,
    "amplify": checks_amplify.check_amplify,
    "vertical_error": checks_terrain.check_vertical_error,
    "queries_ground": checks_queries.check_queries_ground,
    "queries_mesh": checks_queries.check_queries_mesh,
    "bandwidth": checks_tessellator.check_bandwidth,
}
