"""Levels of detail at one camera, measured: as asked for, at equal triangles, at equal error.

Distance LOD gives near patches more triangles; coplanarity LOD near and rough ones;
screen-error LOD those that a given error in the picture needs. At their defaults they differ in
triangles *and* in error, which settles nothing. So all but one are tuned twice more: until they
draw as many triangles as that one, and until they are as far off in the picture.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from statistics import median
from typing import Any, Final

from ..camera.camera import Camera
from ..errors import InputError
from ..measure.error import VerticalError, vertical_error
from ..measure.screen_error import ScreenError, seen_error
from ..mesh.mesh import Mesh
from ..terrain.lod import AnyLod, Lod, PromiseLod, Weighted, unweighted
from ..terrain.lod_formulas import DistanceLod
from ..terrain.lod_promises import ScreenErrorLod
from ..terrain.lods import name_of
from ..terrain.terrain import Terrain
from .matching import Tunable, excess_share, tuned

# triangle counts within this share of each other count as equal
EQUAL_SHARE: Final = 0.01
# and largest errors in the picture, which jump more, within this one
EQUAL_ERROR_SHARE: Final = 0.05

_RUNS: Final = 5  # of each trial, in turn


@dataclass(frozen=True, eq=False)
class Trial:
    """One level of detail at the camera.

    Attributes
    ----------
    name : str
        Of the level of detail; tuned ones end in ``_equal_triangles`` or ``_equal_error``.
    terrain : Terrain
        What it was tried on.
    lod : Lod, PromiseLod or Weighted
    parameters : dict of str to float
        Of the level of detail, those included that it takes from the ground.
    mesh : Mesh
    error : VerticalError
        With its field, over the patches in view.
    seen : ScreenError
        The same in pixels of the picture, over the samples in view.
    runs : tuple of dict of str to float
        Device seconds by stage, of each run; the trials took turns.
    """

    name: str
    terrain: Terrain
    lod: AnyLod
    parameters: dict[str, float]
    mesh: Mesh
    error: VerticalError
    seen: ScreenError
    runs: tuple[dict[str, float], ...] = ()

    @property
    def called(self) -> str:
        """What people read inside a sentence: "screen-error LOD"."""
        return f"{self.name.partition('_equal')[0]} LOD"

    @property
    def title(self) -> str:
        """The same at the beginning of one: "Screen-error LOD"."""
        return self.called[:1].upper() + self.called[1:]

    @property
    def triangles(self) -> int:
        return len(self.mesh.triangles)

    @property
    def seconds(self) -> dict[str, float]:
        """Median device time by stage."""
        stages = dict.fromkeys(stage for run in self.runs for stage in run)
        return {stage: median(run.get(stage, 0.0) for run in self.runs) for stage in stages}

    @property
    def totals(self) -> list[float]:
        """Device time of all stages, of each run; the fastest first."""
        return sorted(sum(run.values()) for run in self.runs)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Trials on one ground at one camera.

    Attributes
    ----------
    terrain : Terrain
        That of distance LOD.
    camera : Camera
    edge_rule, partitioning : str
        Distance LOD's rule for shared edges, and how edges are divided.
    asked : tuple of Trial
        At the parameters asked for: distance LOD, the other, and screen-error LOD unless that is
        the other.
    equal_triangles, equal_error : tuple of Trial
        The same again, tuned until they draw as many triangles as the other, or are as far off
        in the picture; the other is as it was. Empty where it draws nothing, or has no error.
    """

    terrain: Terrain
    camera: Camera
    edge_rule: str
    partitioning: str
    asked: tuple[Trial, ...]
    equal_triangles: tuple[Trial, ...]
    equal_error: tuple[Trial, ...]

    @property
    def distance(self) -> Trial:
        return self.asked[0]

    @property
    def other(self) -> Trial:
        """What the rest is tuned to."""
        return self.asked[1]

    @property
    def trials(self) -> tuple[Trial, ...]:
        """All of them, each once."""
        every = (*self.asked, *self.equal_triangles, *self.equal_error)
        return tuple({trial.name: trial for trial in every}.values())

    def draws_as_many(self, trial: Trial) -> bool:
        """Whether a trial draws as many triangles as the other, or fewer and is nearer even so."""
        excess = excess_share(trial.triangles, self.other.triangles)
        return abs(excess) <= EQUAL_SHARE or self._is_better(trial)

    def is_as_far_off(self, trial: Trial) -> bool:
        """Whether a trial is as far off in the picture, or less with fewer triangles even so."""
        excess = excess_share(trial.seen.maximum, self.other.seen.maximum)
        return abs(excess) <= EQUAL_ERROR_SHARE or self._is_better(trial)

    def _is_better(self, trial: Trial) -> bool:
        other = self.other
        return trial.triangles < other.triangles and trial.seen.maximum < other.seen.maximum


def compare_at(
    terrain: Terrain,
    camera: Camera,
    *,
    distance: DistanceLod,
    lod: AnyLod,
    tree: Terrain | None = None,
    edge_rule: str | None = None,
    partitioning: str = "fractional_odd",
    step: Callable[[], None] = lambda: None,
) -> Comparison:
    """Mesh and measure the levels of detail as asked for, at equal triangles, at equal error.

    `terrain` is what formulas are tried on, `tree` what promises are. Calls `step` three times;
    the rest is as for :func:`terrain_lod.report`.
    """
    if isinstance(lod, DistanceLod):
        raise InputError("expected another level of detail than distance, which it is compared to")
    trying = _Trying(terrain, tree or terrain, camera, edge_rule, partitioning)
    lods: list[AnyLod] = [distance, lod]
    if not isinstance(unweighted(lod), ScreenErrorLod):
        lods.append(ScreenErrorLod())
    asked = tuple(trying.trial(name_of(each), each) for each in lods)
    other = asked[1]
    step()

    def again(suffix: str, tune: Callable[[Tunable], Tunable]) -> tuple[Trial, ...]:
        return tuple(
            trying.trial(trial.name + suffix, tune(trial.lod))
            if trial is not other and isinstance(trial.lod, DistanceLod | ScreenErrorLod)
            else trial
            for trial in asked
        )

    equal_triangles: tuple[Trial, ...] = ()
    equal_error: tuple[Trial, ...] = ()
    if other.triangles:
        equal_triangles = again(
            "_equal_triangles", lambda each: trying.with_triangles(each, other.triangles)
        )
    if other.seen.maximum > 0:
        equal_error = again(
            "_equal_error", lambda each: trying.with_error(each, other.seen.maximum)
        )
    step()
    made = Comparison(
        terrain, camera, edge_rule or "min", partitioning, asked, equal_triangles, equal_error
    )
    made = trying.timed(made)
    step()
    return made


@dataclass(frozen=True, eq=False)
class _Trying:
    """How every level of detail is meshed and measured."""

    terrain: Terrain
    tree: Terrain
    camera: Camera
    edge_rule: str | None
    partitioning: str

    def mesh(self, lod: AnyLod) -> Mesh:
        """Return a mesh: promises come with their own edges and partitioning."""
        if isinstance(unweighted(lod), PromiseLod):
            return self.tree.mesh(self.camera, lod=lod)
        how: dict[str, Any] = {"edge_rule": self.edge_rule, "partitioning": self.partitioning}
        return self.terrain.mesh(self.camera, lod=lod, **how)

    def measured(self, mesh: Mesh) -> tuple[VerticalError, ScreenError]:
        ground = self.terrain.ground
        error = vertical_error(mesh, ground, field=True, device=self.terrain.device)
        assert error.field is not None  # asked for
        return error, seen_error(error.field, ground, self.camera)

    def trial(self, name: str, lod: AnyLod) -> Trial:
        terrain = self.tree if isinstance(unweighted(lod), PromiseLod) else self.terrain
        mesh = self.mesh(lod)
        return Trial(name, terrain, lod, _parameters(lod, terrain), mesh, *self.measured(mesh))

    def with_triangles(self, lod: Tunable, triangles: int) -> Tunable:
        """Return `lod` where it draws `triangles`, to within 1 %."""
        return tuned(
            lod,
            triangles,
            lambda each: len(self.mesh(each).triangles),
            share=EQUAL_SHARE / 10,
            rises=True,
        )

    def with_error(self, lod: Tunable, pixels: float) -> Tunable:
        """Return `lod` where it is `pixels` off at the most, to within 5 %."""
        return tuned(
            lod,
            pixels,
            lambda each: self.measured(self.mesh(each))[1].maximum,
            share=EQUAL_ERROR_SHARE / 5,
            rises=False,
        )

    def timed(self, made: Comparison) -> Comparison:
        """Return the comparison with times: all trials in turn, so that all meet the same load."""
        runs: dict[str, list[dict[str, float]]] = {trial.name: [] for trial in made.trials}
        for _ in range(_RUNS):
            for trial in made.trials:
                runs[trial.name].append(self.mesh(trial.lod).timings)
        timed = {trial.name: replace(trial, runs=tuple(runs[trial.name])) for trial in made.trials}

        def of(trials: tuple[Trial, ...]) -> tuple[Trial, ...]:
            return tuple(timed[trial.name] for trial in trials)

        return replace(
            made,
            asked=of(made.asked),
            equal_triangles=of(made.equal_triangles),
            equal_error=of(made.equal_error),
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
