"""Units of length by name and by size, and what ground says of its own."""

from __future__ import annotations

import numpy as np
import pytest

from terrain_lod.errors import InputError
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.ground.units import UNITS, symbol, unit_called, unit_of_length

FLAT = np.ones((3, 3))


@pytest.mark.parametrize(
    ("names", "unit"),
    [
        (("m", "metre", "Meters", "METRES", "m "), "metre"),
        (("ft", "feet", "Foot", "foot (International)", "International feet"), "foot"),
        (("US survey foot", "us-ft", "ftUS", "Foot_US", "US Survey Feet", "foot (US)",
          "Linear_Foot_US_Survey".removeprefix("Linear_")), "US survey foot"),
        (("cm", "centimeters"), "centimetre"),
        (("km",), "kilometre"),
    ],
)  # fmt: skip
def test_names(names: tuple[str, ...], unit: str) -> None:
    for name in names:
        found = unit_called(name)
        assert found is not None, name
        assert found.name == unit


def test_nobodys_name() -> None:
    assert unit_called("") is None
    assert unit_called("smoot") is None


def test_length_decides_between_feet() -> None:
    assert unit_of_length("foot", 0.3048).name == "foot"
    assert unit_of_length("foot", 0.3048006096012192).name == "US survey foot"
    clarke = unit_of_length("Clarke's foot", 0.3047972654)
    assert (clarke.name, clarke.metres) == ("Clarke's foot", 0.3047972654)
    for unit in UNITS:
        assert unit_of_length("x", unit.metres) == unit
        assert unit_called(unit.name) == unit


def test_symbols() -> None:
    assert [symbol(name) for name in ("metre", "foot", "US survey foot", "smoot")] == [
        "m", "ft", "us-ft", "smoot",
    ]  # fmt: skip


def test_ground_says_its_units() -> None:
    assert Heightmap(FLAT).units == ("metre", "metre")
    ground = Heightmap(FLAT, spacing=5, units=("US survey foot", "foot"))
    assert ground.unit_symbols == ("us-ft", "ft")
    assert repr(ground) == "Heightmap(3 x 3, spacing=(5, 5) us-ft, heights 1 to 1 ft)"
    changed, _, _ = ground.with_elevations(slice(0, 1), slice(0, 1), [[3.0]])
    finer = ground.with_detail(Heightmap(np.zeros((2, 2)), spacing=2.5))
    assert changed.units == finer.units == ground.units


@pytest.mark.parametrize("units", ["metre", ("metre",), ("metre", 1), 3, None])
def test_units_are_two_strings(units: object) -> None:
    with pytest.raises(InputError, match=r"expected units as|a string for units"):
        Heightmap(FLAT, units=units)  # type: ignore[arg-type]


def test_a_hole_may_hold_what_float32_cannot() -> None:
    heights = np.array([[1.0, 2.1], [3.0, -1.797e308]])
    ground = Heightmap(heights, mask=heights < -1e300)
    np.testing.assert_allclose(ground.elevation, [[1, 2.1], [3, np.nan]], rtol=1e-6)
