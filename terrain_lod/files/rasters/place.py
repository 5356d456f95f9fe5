"""Where a raster stands in the world, and in what unit: everything in one, and true to scale."""

from __future__ import annotations

import logging
import re
from dataclasses import dataclass
from typing import Final, Literal

from ...arguments import finite, steps, text, told
from ...errors import InputError
from ...ground.units import METRE, UNITS, Unit, unit_called
from . import mercator
from .degrees import TOLERANCE, Pair, flat_degrees, map_stretch, told_apart
from .raster import Raster
from .wkt import System

MAP: Final = "map"
Spacing = float | Pair | Literal["map"]

log = logging.getLogger(__name__)

_LOCAL: Final = re.compile(
    r'LOCAL_CS\["(?P<of>(?:degrees of )?(?P<code>\w+:\w+)|degrees|its CRS) '
    r'times (?P<east>[-+.\de]+) east, (?P<north>[-+.\de]+) north"'
)


@dataclass(frozen=True)
class Place:
    """Where samples stand: spacing and origin in `unit`, in a CRS, and what to warn of."""

    spacing: Pair
    origin: Pair
    crs: str | None
    unit: Unit = METRE
    notes: tuple[str, ...] = ()


def place_of(raster: Raster, name: str, spacing: Spacing | None) -> Place:
    """Return where a raster stands; `spacing` as `load` takes it, or ``"map"``."""
    in_map_units = isinstance(spacing, str) and spacing == MAP
    if isinstance(spacing, str) and not in_map_units:
        raise InputError(f'expected one or two numbers or "map" for spacing, got {told(spacing)}')
    given = None if spacing is None or in_map_units else steps("spacing", spacing)
    system, origin = raster.system, raster.origin or (0.0, 0.0)
    unit = system.unit or METRE
    if raster.step is None:
        if given or in_map_units:
            return Place(given or (1.0, 1.0), origin, system.crs, unit)
        note = f"{name} does not say how far apart its samples are: taken as 1; give spacing="
        return Place((1.0, 1.0), origin, system.crs, unit, (note,))
    if system.angle is not None or _could_be_degrees(raster):
        if in_map_units:
            raise InputError(
                f'expected a projected CRS with spacing="map", got {name} in '
                f"{'an unknown unit' if system.angle is None else system.angle.name + 's'}, "
                "which heights are not in"
            )
        return _from_degrees(raster, name, given)
    if given or in_map_units:
        return Place(given or raster.step, origin, system.crs, unit)
    return _true_to_scale(raster, name)


def height_factor(
    raster: Raster, unit: Unit, name: str, z_unit: str | None, z_scale: float | None
) -> tuple[float, tuple[str, ...]]:
    """Return what brings the file's heights to `unit`, that of x and y, and what to warn of."""
    scale = 1.0 if z_scale is None else finite("z_scale", z_scale)
    if scale == 0:
        raise InputError("expected a z_scale other than 0, which would make all ground flat")
    if z_unit is not None:
        chosen = unit_called(text("z_unit", z_unit))
        if chosen is None:
            names = ", ".join(known.name for known in UNITS)
            raise InputError(f"expected one of {names} for z_unit, got {told(z_unit)}")
        return scale * _ratio(chosen, unit), ()
    if z_scale is not None:
        return scale, ()
    said = raster.height_unit
    found = unit_called(said) if said else raster.system.height_unit
    if found is not None:
        if found != unit:
            log.info("%s has heights in %s: brought to %s", name, found.name, unit.name)
        return _ratio(found, unit), ()
    assumed = _assumed(unit)
    notes: tuple[str, ...] = ()
    if said and said.lower() not in UNSAID:
        notes = (f"{name} has heights in {said!r}, an unknown unit: taken as {assumed.name}; "
                 "z_unit= says otherwise",)  # fmt: skip
    elif assumed != METRE:
        notes = (f"{name} is in {unit.name} and does not say what its heights are in: taken as "
                 f"{assumed.name}, too; z_unit= says otherwise",)  # fmt: skip
    return _ratio(assumed, unit), notes


def unit_of_heights(system: System) -> Unit:
    """Return the unit of heights that a system names, or else the one that goes with its map."""
    return system.height_unit or _assumed(system.unit or METRE)


def _assumed(unit: Unit) -> Unit:
    # feet go with feet, as surveys have them; on any other map heights are metres
    return unit if "foot" in unit.name else METRE


# what programs write for a unit that they do not know
UNSAID: Final = (
    "unspecified",
    "unknown",
    "none",
    "undefined",
    "n/a",
    "unitless",
    "1",
    "dimensionless",
)


def _ratio(of: Unit, to: Unit) -> float:
    return 1.0 if of == to else of.metres / to.metres


def _from_degrees(raster: Raster, name: str, given: Pair | None) -> Place:
    """Return the place of a raster in longitude and latitude, in local metres."""
    assert raster.step is not None
    origin, angle, ellipsoid = (
        raster.origin or (0.0, 0.0),
        raster.system.angle,
        raster.system.ellipsoid,
    )
    step = given
    if step is None:
        if angle is None:
            raise InputError(
                f"expected {name} to name its CRS, got none and steps of {raster.step[0]:g}, which "
                "could be degrees or metres: give spacing= in metres"
            )
        if raster.origin is None:
            raise InputError(
                f"expected a name such as N46E007.hgt that says where the tile is, got {name}: "
                "rename it, or give spacing= in metres"
            )
        north = origin[1] * angle.degrees
        south = north - (len(raster.values) - 1) * raster.step[1] * angle.degrees
        per_degree, off = flat_degrees(north, south, name, ellipsoid)
        per_unit = per_degree[0] * angle.degrees, per_degree[1] * angle.degrees
        step = raster.step[0] * per_unit[0], raster.step[1] * per_unit[1]
        log.info(
            "%s is in %ss: made local metres at latitude %.4f, %.3f m x %.3f m between samples; "
            "east-west lengths at its edges are off by %.2g %%",
            name, angle.name, (north + south) / 2, *step, 100 * off,
        )  # fmt: skip
    per_unit = step[0] / raster.step[0], step[1] / raster.step[1]
    crs = raster.system.crs
    if angle is not None:
        code = raster.system.horizontal
        of = f" of {code}" if code is not None and _is_code(code) else ""
        crs = _local(f"{angle.name}s{of}", per_unit)
    return Place(step, (origin[0] * per_unit[0], origin[1] * per_unit[1]), crs)


def _true_to_scale(raster: Raster, name: str) -> Place:
    """Return the place of a projected raster, its map's stretch taken out where it is a lot.

    Every map stretches. That of the web does so by design, all but at the equator, and its
    stretch is taken out always; any other's where it is more than `TOLERANCE`.
    """
    assert raster.step is not None
    system, origin = raster.system, raster.origin or (0.0, 0.0)
    unit = system.unit or METRE
    as_it_is = Place(raster.step, origin, system.crs, unit)
    if raster.geographic is None:
        return as_it_is
    rows, columns = raster.values.shape
    extent = raster.step[0] * (columns - 1), raster.step[1] * (rows - 1)
    measured = map_stretch(raster.geographic, origin, extent, system.ellipsoid)
    if measured is None:
        return as_it_is
    (east, north), off = measured
    east, north = east / unit.metres, north / unit.metres
    web = system.horizontal in mercator.CODES
    if not web and max(abs(east - 1), abs(north - 1)) <= TOLERANCE:
        return as_it_is
    code = system.horizontal if system.horizontal and _is_code(system.horizontal) else "its CRS"
    if off > TOLERANCE:
        tolerance, got = told_apart(TOLERANCE, off)
        raise InputError(
            f"expected {name}, in {code}, to fit a flat grid true to scale to {tolerance}, got "
            f'{got} at its edges: take a part with bounds=, reproject it, or give spacing="map" '
            "for the map's own units"
        )
    spacing = raster.step[0] * east, raster.step[1] * north
    log.info(
        "%s is in %s, a map %.4f x %.4f too large in its middle: made true to scale, "
        "%.3f x %.3f %s between samples; lengths at its edges are off by %.2g %%; "
        'spacing="map" keeps the map\'s',
        name, code, 1 / east, 1 / north, *spacing, unit.symbol, 100 * off,
    )  # fmt: skip
    crs = _local(code, (east, north), unit)
    return Place(spacing, (origin[0] * east, origin[1] * north), crs, unit)


def _could_be_degrees(raster: Raster) -> bool:
    """Return whether a raster that names no CRS might as well be in degrees as in metres."""
    if raster.system.crs is not None or raster.step is None or raster.origin is None:
        return False
    (x, y), (dx, dy) = raster.origin, raster.step
    # steps of 72 arc-seconds or 2 cm, and numbers that are longitudes and latitudes
    return 0 < max(dx, dy) < 0.02 and -180 <= x <= 360 and -90 <= y <= 90


def map_of(crs: str) -> tuple[str, Pair]:
    """Return the map that lengths of a CRS were on, and what one of its units is in them.

    The way back from what :func:`_local` writes; any other CRS is its own map.

    Raises
    ------
    InputError
        If the map has no code to find it by.
    """
    found = _LOCAL.match(crs)
    if found is None:
        return crs, (1.0, 1.0)
    code = found["code"] or ("EPSG:4326" if found["of"].startswith("degrees") else "")
    if not code:
        raise InputError(f"expected ground on a map with a code, such as EPSG:3857, got {crs[:60]}")
    return code, (float(found["east"]), float(found["north"]))


def _is_code(crs: str) -> bool:
    return len(crs) < 40 and ":" in crs and "[" not in crs


def _local(of: str, scale: Pair, unit: Unit = METRE) -> str:
    """Return WKT for local lengths that says how to get back to what they were."""
    east, north = (f"{factor:.6f}" if factor > 10 else f"{factor:.12g}" for factor in scale)
    return (
        f'LOCAL_CS["{of} times {east} east, {north} north",UNIT["{unit.name}",{unit.metres:.15g}]]'
    )
