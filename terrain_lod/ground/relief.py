"""What a terrain shows: a heightmap, and perhaps a small one laid all over it, again and again.

The sum of both is only found where it is read, by kernels (``terrain/ground.h``) as by
:meth:`Heightmap.with_detail`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..arguments import instance
from .heightmap import Heightmap


@dataclass(frozen=True, eq=False)
class Relief:
    """A heightmap and its detail; :meth:`Heightmap.with_detail` describes the sum.

    Attributes
    ----------
    ground : Heightmap
    detail : Heightmap or None
    steps : (int, int)
        Samples of the detail a cell of the ground, along x and y; 1 without detail.

    Raises
    ------
    InputError
        If the detail does not fit the ground.
    """

    ground: Heightmap
    detail: Heightmap | None = None
    steps: tuple[int, int] = field(init=False, default=(1, 1))

    def __post_init__(self) -> None:
        instance("a Heightmap for ground", self.ground, Heightmap)
        if self.detail is not None:
            object.__setattr__(self, "steps", self.ground.steps_of(self.detail))

    @property
    def shape(self) -> tuple[int, int]:
        """Samples of the sum along y and x."""
        (rows, columns), (across, down) = self.ground.shape, self.steps
        return (rows - 1) * down + 1, (columns - 1) * across + 1

    @property
    def spacing(self) -> tuple[float, float]:
        """Of the sum, along x and y."""
        (dx, dy), (across, down) = self.ground.spacing, self.steps
        return dx / across, dy / down

    @property
    def base(self) -> float:
        """Added to every sum of heights."""
        return self.ground.base + (0.0 if self.detail is None else self.detail.base)

    def touching(self, rows: slice, columns: slice) -> tuple[slice, slice]:
        """Return the samples of the sum that depend on these of the ground, start and stop given.

        Those up to the next samples of the ground on either side do.
        """
        (all_rows, all_columns), (across, down) = self.shape, self.steps
        return _around(rows, down, all_rows), _around(columns, across, all_columns)

    def sum(self) -> Heightmap:
        """Return ground and detail in one, in as much memory as that takes."""
        return self.ground if self.detail is None else self.ground.with_detail(self.detail)


def _around(part: slice, steps: int, extent: int) -> slice:
    return slice(max((part.start - 1) * steps + 1, 0), min(part.stop * steps, extent))
