"""How the command line reads ground."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rasterio
from rasterio.transform import Affine

from support.rasters import write_tiff
from terrain_lod.cli.app import run

HILLS = np.add.outer(np.arange(40.0), np.arange(50.0)).astype(np.float32)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    place = Affine(25, 0, 980_000, 0, -25, 200_000)
    path = write_tiff(tmp_path / "a.tif", np.stack([HILLS, HILLS * 2]), crs="EPSG:2263",
                      transform=place)  # fmt: skip
    with rasterio.open(path, "r+") as file:
        file.units = ("metre", "US survey foot")
    return tmp_path


@pytest.mark.parametrize(
    "options",
    [
        ["--band", "2"],
        ["--band", "1", "--window", "3,4,20,20"],
        ["--band", "1", "--bounds", "980000,199500,980500,200000", "--z-unit", "foot"],
        ["--band", "1", "--z-scale", "0.5", "--spacing", "map"],
    ],
)
def test_options_reach_the_file(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        run(["mesh", "a.tif", "-o", "a.glb", "--lod", "max-error", "--metres", "1", *options]) == 0
    )
    assert " us-ft" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--overview", "0", "--band", "1"], "that a.tif has, none"),
        ([], "choose with band="),
        (["--band", "1", "--z-unit", "smoot"], "for z_unit"),
        (["--band", "1", "--window", "0,0,90,90"], "within 50 x 40 samples"),
        (["--band", "1", "--bounds", "1,2,3"], "WEST,SOUTH,EAST,NORTH"),
        (["--band", "1", "--spacing", "maps"], "DX[,DY]|map"),
    ],
)
def test_refused(options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["mesh", "a.tif", "-o", "a.glb", *options]) == 2
    assert words in capsys.readouterr().err
    assert not Path("a.glb").exists()
