"""One check a kernel: what a device computes against the float64 reference.

The doctor runs the ordinary cases, ``terrain-lod report --stability`` and the tests run them all.
A new kernel's check is a comparison, its cases and bounds, and one row here.
"""

from __future__ import annotations

from typing import Final

from . import (
    common,
    curved,
    curved_displaced,
    curved_pn,
    floating,
    measure,
    mesh,
    promise,
    quadtree,
    streaming,
    terrain,
)
from . import tessellation as patterns
from .check import Check

CHECKS: Final[dict[str, Check]] = {
    # by the kernel's file, without its ending
    "common/bandwidth": common.BANDWIDTH,
    "common/scan": common.SCAN,
    "tessellation/tessellator": patterns.TESSELLATOR,
    "tessellation/queues": patterns.QUEUES,
    "tessellation/semi_uniform": patterns.SEMI_UNIFORM,
    "tessellation/semi_uniform, quads": patterns.SEMI_UNIFORM_QUADS,
    "terrain/analysis": terrain.ANALYSIS,
    "terrain/control_points": terrain.CONTROL_POINTS,
    "terrain/hull": terrain.HULL,
    "terrain/domain": terrain.DOMAIN,
    "terrain/holes": terrain.HOLES,
    "terrain/queries": terrain.QUERIES,
    "terrain/ladder": promise.LADDER,
    "terrain/selection": promise.SELECTION,
    "terrain/tile_error": promise.TILE_ERROR,
    "terrain/weights": promise.WEIGHTS,
    "terrain/tree": quadtree.TREE,
    "terrain/choice": quadtree.CHOICE,
    "terrain/leaves": quadtree.LEAVES,
    "terrain/joints": quadtree.JOINTS,
    "terrain/leaf_fit": quadtree.LEAF_FIT,
    "terrain/fitted": quadtree.FITTED,
    "terrain/floating": floating.FLOATING,
    "streaming/between": streaming.BETWEEN,
    "curved/bezier": curved.BEZIER,
    "curved/bezier_curve": curved.BEZIER_CURVE,
    "curved/bezier, tangents": curved.TANGENTS,
    "curved/surface": curved.SURFACE,
    "curved/curve": curved.CURVE,
    "curved/pn_hull": curved_pn.HULL,
    "curved/pn_edges": curved_pn.EDGES,
    "curved/pn_patches": curved_pn.PATCHES,
    "curved/pn_domain": curved_pn.DOMAIN,
    "curved/pn_blend": curved_pn.BLEND,
    "curved/displaced": curved_displaced.DISPLACED,
    "curved/displaced_normals": curved_displaced.NORMALS,
    "curved/decals": curved_displaced.DECALS,
    "curved/decal_reach": curved_displaced.REACH,
    "curved/decal_reach, views": curved_displaced.VIEWS,
    "mesh/queries": mesh.QUERIES,
    "measure/vertical_error": measure.VERTICAL_ERROR,
}
