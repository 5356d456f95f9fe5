"""How far triangles are from samples: the finished mesh, on the Earth, at every sample.

A sample's distance is taken along the ellipsoid's normal through it, twice: to the flat triangle
between its three earth-centred corners, which is what is drawn, and to the height that is linear in
longitude and latitude between the heights of the corners, which is what clients answer when they
are asked for a height. The larger counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .ellipsoid import Floats, earth_centred, on_ellipsoid, upwards
from .schemes import Bounds
from .source import Samples, Source

Triangles = npt.NDArray[np.int32]

# samples this close to a side, in samples, belong to the triangle
_NEAR = 1e-6
_NEAR_DEGREES = 1e-9


@dataclass(frozen=True, eq=False)
class Seen:
    """Samples, as distances are worked out from them.

    Attributes
    ----------
    east, north : (S,) float64
        Degrees from a surface's middle.
    height : (S,) float64
    up : (S, 3) float64
        Normals of the ellipsoid.
    foot : (S, 3) float64
        Where these leave it, relative to where the middle is.
    """

    east: Floats
    north: Floats
    height: Floats
    up: Floats
    foot: Floats

    def chosen(self, which: npt.NDArray[np.int64]) -> Seen:
        return Seen(*(values[which] for values in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles on the Earth.

    Attributes
    ----------
    longitude, latitude, height : (V,) float64
        Of the vertices.
    triangles : (T, 3) int32
        Counter-clockwise.
    middle : (2,) float64
        Longitude and latitude that lengths are small around.
    """

    longitude: Floats
    latitude: Floats
    height: Floats
    triangles: Triangles
    middle: Floats

    @classmethod
    def of(
        cls, bounds: Bounds, size: int, places: npt.NDArray[np.int64], heights: Floats,
        triangles: Triangles,
    ) -> Surface:  # fmt: skip
        """Return the surface of vertices on a tile's grid of `size` steps."""
        west, south, east, north = bounds
        share = places / size
        return cls(
            west + (east - west) * share[:, 0],
            south + (north - south) * share[:, 1],
            heights,
            triangles,
            np.array([(west + east) / 2, (south + north) / 2]),
        )

    @cached_property
    def points(self) -> Floats:
        """Earth-centred places of the vertices; (V, 3)."""
        return earth_centred(self.longitude, self.latitude, self.height)

    def seen(self, samples: Samples) -> Seen:
        """Return what of samples their distances are worked out from."""
        up = upwards(samples.longitude, samples.latitude)
        return Seen(
            samples.longitude - self.middle[0],
            samples.latitude - self.middle[1],
            samples.height,
            up,
            on_ellipsoid(up) - self._origin,
        )

    def residuals(self, seen: Seen, owners: npt.NDArray[np.int64]) -> Floats:
        """Return the distance of each sample from its triangle; (S,)."""
        used = np.zeros(len(self.triangles), bool)
        used[owners] = True
        number = np.cumsum(used) - 1
        corners = self.triangles[used]
        a, b, c = np.moveaxis(self.points[corners] - self._origin, 1, 0)
        # the plane of each triangle: normal . point = constant
        normals = np.cross(b - a, c - a)
        constants = np.einsum("ij,ij->i", normals, a)
        x, y, z = (
            values[corners]
            for values in (
                self.longitude - self.middle[0], self.latitude - self.middle[1], self.height
            )
        )  # fmt: skip
        # height = constant + slopes . place
        ux, uy, rise_u = (values[:, 1] - values[:, 0] for values in (x, y, z))
        vx, vy, rise_v = (values[:, 2] - values[:, 0] for values in (x, y, z))
        area = ux * vy - uy * vx
        east, north = (rise_u * vy - rise_v * uy) / area, (rise_v * ux - rise_u * vx) / area
        level = z[:, 0] - east * x[:, 0] - north * y[:, 0]
        owners = number[owners]
        normal = normals[owners]
        over = constants[owners] - np.einsum("ij,ij->i", normal, seen.foot)
        drawn = over / np.einsum("ij,ij->i", normal, seen.up)
        linear = level[owners] + east[owners] * seen.east + north[owners] * seen.north
        return np.asarray(np.maximum(abs(drawn - seen.height), abs(linear - seen.height)))

    @cached_property
    def _origin(self) -> Floats:
        """Where the ellipsoid is at the middle: around it, earth-centred numbers are small."""
        return on_ellipsoid(upwards(self.middle[0], self.middle[1]))

    def owners(self, samples: Samples, source: Source) -> npt.NDArray[np.int64]:
        """Return the triangle that each sample stands over, -1 where there is none; (S,).

        Triangles are filled row by row on the raster, where samples stand at whole numbers.
        """
        top, left = int(samples.rows.min()), int(samples.columns.min())
        height = int(samples.rows.max()) - top + 1
        width = int(samples.columns.max()) - left + 1
        rows, columns = source.pixels(self.longitude, self.latitude)
        near = self._near(samples)
        y, x = ((places - first)[self.triangles[near]]
                for places, first in ((rows, top), (columns, left)))  # fmt: skip
        first = np.clip(np.ceil(y.min(axis=1) - _NEAR), 0, height).astype(np.int64)
        stop = np.clip(np.floor(y.max(axis=1) + _NEAR) + 1, 0, height).astype(np.int64)
        counts = np.maximum(stop - first, 0)
        triangle = np.repeat(np.arange(len(counts)), counts)
        row = _runs(first, counts)
        # where the row meets the three sides
        low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)
        for begin, end in ((0, 1), (1, 2), (2, 0)):
            y0, y1 = y[triangle, begin], y[triangle, end]
            x0, x1 = x[triangle, begin], x[triangle, end]
            lower, upper = np.minimum(y0, y1), np.maximum(y0, y1)
            meets = (row >= lower - _NEAR) & (row <= upper + _NEAR)
            rise = np.where(y1 == y0, 1.0, y1 - y0)
            share = np.clip((row - y0) / rise, 0.0, 1.0)
            flat = y1 == y0
            at = x0 + (x1 - x0) * share
            low = np.where(meets, np.minimum(low, np.where(flat, np.minimum(x0, x1), at)), low)
            high = np.where(meets, np.maximum(high, np.where(flat, np.maximum(x0, x1), at)), high)
        low, high = np.nan_to_num(low, posinf=1e9), np.nan_to_num(high, neginf=-1e9)
        begin_x = np.clip(np.ceil(low - _NEAR), 0, width).astype(np.int64)
        stop_x = np.clip(np.floor(high + _NEAR) + 1, 0, width).astype(np.int64)
        lengths = np.maximum(stop_x - begin_x, 0)
        owner = np.full(height * width, -1, np.int64)
        owner[_runs(row * width + begin_x, lengths)] = np.repeat(near[triangle], lengths)
        return np.asarray(owner[(samples.rows - top) * width + samples.columns - left])

    def _near(self, samples: Samples) -> npt.NDArray[np.int64]:
        """Return the triangles whose degrees meet those of the samples.

        Others may come to lie on the raster, too: a zone's map is none of the whole Earth.
        """
        near = np.ones(len(self.triangles), np.bool_)
        for corners, places in (
            (self.longitude[self.triangles], samples.longitude),
            (self.latitude[self.triangles], samples.latitude),
        ):
            near &= corners.min(axis=1) <= places.max() + _NEAR_DEGREES
            near &= corners.max(axis=1) >= places.min() - _NEAR_DEGREES
        return np.flatnonzero(near)


def _runs(starts: npt.NDArray[np.int64], lengths: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return start, start + 1, ... of each run, one run after the other."""
    ends = np.cumsum(lengths)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) - np.repeat(ends - lengths - starts, lengths)
