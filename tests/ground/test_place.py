"""Where places are: degrees where they are known, never degrees that were made metres."""

from __future__ import annotations

import numpy as np
import pytest

from terrain_lod.ground.place import degrees_of, said_in_degrees, said_place

LOCAL = 'LOCAL_CS["degrees of EPSG:4326 times 70000 east, 111000 north",UNIT["metre",1]]'


def test_maps_say_degrees_and_their_own_numbers():
    pytest.importorskip("pyproj")
    degrees, own = said_place("EPSG:32632", 500_000.0, 5_200_000.0, "m")
    # on the zone's meridian: as far along the ellipsoid of WGS 84 as the northing says
    turn = np.radians(np.linspace(0, 46.95353, 10_001))
    squared = 0.00669437999014
    metres = 6_378_137 * (1 - squared) / (1 - squared * np.sin(turn) ** 2) ** 1.5
    assert 0.9996 * np.trapezoid(metres, turn) == pytest.approx(5_200_000.0, abs=1.0)
    assert degrees == "46.95353° N, 9.00000° E"
    assert own == "x 500,000.0, y 5,200,000.0 in EPSG:32632"


def test_degrees_that_became_metres_are_degrees_again():
    assert said_place(LOCAL, 700_000.0, 5_217_000.0, "m") == ("47.00000° N, 10.00000° E",)
    assert degrees_of(LOCAL, 700_000.0, 5_217_000.0) == pytest.approx((10.0, 47.0))
    assert said_in_degrees("EPSG:4326", -70.5, -33.25) == "33.250° S, 70.500° W"


def test_ground_that_is_nowhere_has_only_its_numbers():
    assert said_place(None, 12.34, 5.0, "ft") == ("x 12.3, y 5.0 ft",)
    assert said_place('LOCAL_CS["plan"]', 1.0, 2.0, "m") == ('x 1.0, y 2.0 in LOCAL_CS["plan"]',)
    assert said_in_degrees(None, 0.0, 0.0) is None
    assert degrees_of("EPSG:3857", np.inf, 0.0) is None
