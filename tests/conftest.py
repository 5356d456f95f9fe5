"""What all tests share.

The same examples every time: a failure is the change's, not the dice's.
"""

from __future__ import annotations

import pytest
from hypothesis import settings

from terrain_lod.files.rasters import readers_gdal

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")


@pytest.fixture(params=["rasterio", "Pillow"])
def route(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Run a test twice: with rasterio, and as if it were not installed."""
    if request.param == "Pillow":
        monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
    return str(request.param)
