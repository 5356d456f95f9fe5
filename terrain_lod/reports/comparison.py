"""Distance LOD and another at one camera, measured: triangles drawn, error, time.

Distance LOD gives near patches more triangles; coplanarity LOD, for one, near and rough ones. At
their defaults they differ in triangles *and* in error, so a third trial settles which is better:
the distance LOD again, its highest factor changed until it draws as many triangles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from statistics import median
from typing import Any, Final

from ..camera.camera import Camera
from ..device.layout import MAX_TILE
from ..errors import InputError
from ..measure.error import VerticalError, vertical_error
from ..mesh.mesh import Mesh
from ..terrain.lod import AnyLod, Lod, PromiseLod, Weighted, unweighted
from ..terrain.lod_formulas import DistanceLod
from ..terrain.lods import name_of
from ..terrain.terrain import Terrain

# triangle counts within this share of each other count as equal
EQUAL_SHARE: Final = 0.01
_BISECTIONS: Final = 24
_RUNS: Final = 5  # of which the median time is reported


@dataclass(frozen=True, eq=False)
class Trial:
    """One level of detail at the camera.

    Attributes
    ----------
    name : str
    terrain : Terrain
        What it was tried on.
    lod : Lod, PromiseLod or Weighted
    parameters : dict of str to float
        Of the level of detail, those included that it takes from the ground.
    mesh : Mesh
    error : VerticalError
        With its field, over the patches in view.
    seconds : dict of str to float
        Median device time by stage.
    """

    name: str
    terrain: Terrain
    lod: AnyLod
    parameters: dict[str, float]
    mesh: Mesh
    error: VerticalError
    seconds: dict[str, float]

    @property
    def title(self) -> str:
        """What people read: "Coplanarity LOD"."""
        name = self.name.removesuffix("_equal")
        return f"{name[:1].upper()}{name[1:]} LOD"

    @property
    def triangles(self) -> int:
        return len(self.mesh.triangles)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Three trials on one ground at one camera.

    Attributes
    ----------
    terrain : Terrain
        That of distance LOD.
    camera : Camera
    edge_rule, partitioning : str
        Distance LOD's rule for shared edges, and how edges are divided.
    distance, other : Trial
        At the parameters asked for.
    equal : Trial
        Distance LOD with as many triangles as the other.
    """

    terrain: Terrain
    camera: Camera
    edge_rule: str
    partitioning: str
    distance: Trial
    other: Trial
    equal: Trial

    @property
    def trials(self) -> tuple[Trial, Trial, Trial]:
        return self.distance, self.other, self.equal

    @property
    def is_equal(self) -> bool:
        """Whether the triangle counts of `equal` and `other` could be made to agree."""
        return abs(_excess(self.equal.triangles, self.other.triangles)) <= EQUAL_SHARE


def compare_pair(
    terrain: Terrain,
    camera: Camera,
    *,
    distance: DistanceLod,
    lod: AnyLod,
    others: Terrain | None = None,
    edge_rule: str | None = None,
    partitioning: str = "fractional_odd",
    step: Callable[[], None] = lambda: None,
) -> Comparison:
    """Mesh and measure both levels of detail, and distance LOD at equal triangle counts.

    Calls `step` after each of the three trials; the rest is as for :func:`terrain_lod.report`.
    """
    if isinstance(lod, DistanceLod):
        raise InputError("expected another level of detail than distance, which it is compared to")
    meshing: dict[str, Any] = {"edge_rule": edge_rule, "partitioning": partitioning}

    def trial(name: str, terrain: Terrain, lod: AnyLod) -> Trial:
        how = {} if isinstance(unweighted(lod), PromiseLod) else meshing
        runs = [terrain.mesh(camera, lod=lod, **how) for _ in range(_RUNS)]
        error = vertical_error(runs[0], terrain.ground, field=True, device=terrain.device)
        # the first run of a promise measures the ladder as well
        stages = runs[-1].timings
        seconds = {stage: median(run.timings[stage] for run in runs) for stage in stages}
        step()
        return Trial(name, terrain, lod, _parameters(lod, terrain), runs[0], error, seconds)

    by_distance = trial("distance", terrain, distance)
    by_other = trial(name_of(lod), others or terrain, lod)
    matched = with_triangles(terrain, camera, distance, by_other.triangles, **meshing)
    equal = trial("distance_equal", terrain, matched)
    return Comparison(
        terrain, camera, edge_rule or "min", partitioning, by_distance, by_other, equal
    )


def _parameters(lod: AnyLod, terrain: Terrain) -> dict[str, float]:
    """Return the numbers that a level of detail works with, weights included."""
    if isinstance(lod, Weighted):
        return {
            **_parameters(lod.lod, terrain),
            "horizon": lod.horizon,
            "silhouette": lod.silhouette,
        }
    return lod.parameters(terrain.scene) if isinstance(lod, Lod) else lod.numbers()


def with_triangles(
    terrain: Terrain,
    camera: Camera,
    lod: DistanceLod,
    triangles: int,
    *,
    edge_rule: str | None = None,
    partitioning: str = "fractional_odd",
) -> DistanceLod:
    """Return `lod` with the highest factor at which it draws `triangles`, to within 1 %.

    Bisects ``maximum`` between ``minimum`` and 63. Where the count jumps past `triangles`, as it
    may with few patches, the nearest count that was met is taken.
    """
    low, high = lod.minimum, float(MAX_TILE)
    best, least = lod, float("inf")
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        candidate = replace(lod, maximum=middle)
        mesh = terrain.mesh(camera, lod=candidate, edge_rule=edge_rule, partitioning=partitioning)
        count = len(mesh.triangles)
        excess = _excess(count, triangles)
        if abs(excess) < least:
            best, least = candidate, abs(excess)
        if least <= EQUAL_SHARE / 10:
            break
        low, high = (low, middle) if excess > 0 else (middle, high)
    return best


def _excess(count: int, wanted: int) -> float:
    """Return by which share of `wanted` the count is too high."""
    return (count - wanted) / max(wanted, 1)


def device_bytes(terrain: Terrain, mesh: Mesh) -> dict[str, int]:
    """Return bytes of device memory that this engine holds for a terrain and for one mesh of it.

    Heights 4 a sample (and 1 for nodata); a tile 2 x 16 for its plane and details, 12 x 4 for
    its patch, a corner 16; then a patch 24 for its factors and 8 for its offsets, a point 8 in
    the domain and 24 in the world, a triangle 12.
    """
    (rows, columns), grid = terrain.ground.shape, terrain.grid
    corners = (grid.shape[0] + 1) * (grid.shape[1] + 1)
    nodata = rows * columns if terrain.ground.mask is not None else 1
    return {
        "terrain": rows * columns * 4 + nodata + grid.count * (32 + 48) + corners * 16,
        "mesh": grid.count * 24
        + (grid.count + 1) * 8
        + len(mesh.vertices) * 32
        + len(mesh.triangles) * 12,
    }
