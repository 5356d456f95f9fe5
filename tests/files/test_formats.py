"""Every door: files told by what is in them, archives, text of all kinds, errors of one line."""

from __future__ import annotations

import codecs
import gzip
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from rasterio.shutil import copy

from support.rasters import GRID, TILE, refusal, write_hgt, write_image, write_tiff
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.rasters import readers_gdal
from terrain_lod.files.rasters.loading import load

WHOLE = GRID.astype(np.int16)
ESRI = "ncols 4\nnrows 3\nxllcorner 5e5\nyllcorner 4e6\ncellsize 30\n"
CENTRES = "ncols 4\nnrows 3\nxllcentre 500015\nyllcentre 4000015\ncellsize 30\n"
BODY = "\n".join(" ".join(map(str, row)) for row in GRID.tolist())
GRASS = "north: 4000090\nsouth: 4000000\neast: 500120\nwest: 500000\nrows: 3\ncols: 4\n"


class TestText:
    @pytest.mark.parametrize(
        "data",
        [
            codecs.BOM_UTF8 + (ESRI + BODY).encode(),
            (ESRI + BODY).encode("utf-16"),
            (ESRI + BODY).replace("\n", "\r\n").encode(),
            (ESRI.upper() + BODY).encode(),
            (GRASS + BODY).encode(),
            (GRASS + "null: -1\ntype: int\n" + BODY).encode(),
            (
                "ncols 4\nnrows 3\nxllcentre 500015\nyllcentre 4000015\ncellsize 30\n" + BODY
            ).encode(),
        ],
    )
    def test_headers(self, tmp_path: Path, data: bytes) -> None:
        (tmp_path / "a.asc").write_bytes(data)
        ground = load(tmp_path / "a.asc")
        np.testing.assert_array_equal(ground.elevation, GRID)
        assert (ground.spacing, ground.origin) == ((30, 30), (500_015, 4_000_075))

    def test_null_and_multiplier_of_grass(self, tmp_path: Path) -> None:
        text = GRASS + "multiplier: 0.1\n" + BODY.replace("120", "*")
        (tmp_path / "a.asc").write_text(text)
        ground = load(tmp_path / "a.asc")
        np.testing.assert_allclose(ground.elevation[1:], GRID[1:] / 10, rtol=1e-6)
        assert np.argwhere(~ground.valid).tolist() == [[0, 0]]

    def test_degrees_of_grass(self, tmp_path: Path) -> None:
        header = "north: 46:30:36N\nsouth: 46:30N\neast: 7W\nwest: 7:00:48W\nrows: 3\ncols: 4\n"
        (tmp_path / "a.asc").write_text(header + BODY)
        ground = load(tmp_path / "a.asc")
        np.testing.assert_allclose(ground.spacing, (76_700 / 300, 111_160 / 300), rtol=1e-3)
        longitude = ground.origin[0] / (ground.spacing[0] * 300)
        np.testing.assert_allclose(longitude, -7 - 42 / 3600)


class TestContent:
    @pytest.mark.parametrize("name", ["a.png", "a.dem", "a.xyz", "a", "a.hgt.tif", "a.asc"])
    def test_a_tiff_under_any_name(self, tmp_path: Path, route: str, name: str) -> None:
        write_tiff(tmp_path / "b.tif", WHOLE).rename(tmp_path / name)
        np.testing.assert_array_equal(load(tmp_path / name).elevation, GRID)

    def test_a_png_under_the_name_of_a_tiff(self, tmp_path: Path, route: str) -> None:
        write_image(tmp_path / "a.png", GRID.astype(np.uint16)).rename(tmp_path / "a.tif")
        np.testing.assert_array_equal(load(tmp_path / "a.tif", spacing=1).elevation, GRID)

    def test_raw_numbers_name_their_header(self, tmp_path: Path) -> None:
        source = write_tiff(tmp_path / "a.tif", WHOLE)
        copy(source, tmp_path / "a.bil", driver="EHdr")
        np.testing.assert_array_equal(load(tmp_path / "a.bil").elevation, GRID)
        (tmp_path / "a.hdr").unlink()
        assert "expected a.hdr beside a.bil" in refusal(FileError, tmp_path / "a.bil")

    def test_archives(self, tmp_path: Path) -> None:
        source = write_tiff(tmp_path / "a.tif", WHOLE)
        (tmp_path / "a.gz").write_bytes(gzip.compress(source.read_bytes()))
        with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
            archive.write(source, "deep in/a folder.tif")
            archive.writestr("deep in/a folder.xml", "about it")
        for name in ("a.gz", "a.zip"):
            np.testing.assert_array_equal(load(tmp_path / name).elevation, GRID)
        with zipfile.ZipFile(tmp_path / "a.zip", "a") as archive:
            archive.write(source, "another.tif")
        words = "one raster in a.zip, got deep in/a folder.tif, another.tif"
        assert words in refusal(InputError, tmp_path / "a.zip")

    def test_a_tile_in_a_zip(self, tmp_path: Path) -> None:
        write_hgt(tmp_path / "N46E007.hgt", TILE)
        with zipfile.ZipFile(tmp_path / "N46E007.hgt.zip", "w") as archive:
            archive.write(tmp_path / "N46E007.hgt", "N46E007.hgt")
        assert load(tmp_path / "N46E007.hgt.zip").shape == (1201, 1201)

    def test_one_of_several_datasets(self, tmp_path: Path) -> None:
        source = write_tiff(tmp_path / "a.tif", np.stack([WHOLE, WHOLE + 1]))
        copy(source, tmp_path / "a.nc", driver="netCDF", WRITE_BOTTOMUP="NO")
        words = "got Band1, Band2: take one out"
        assert words in refusal(InputError, tmp_path / "a.nc")

    def test_errors_of_gdal_are_one_line(self, tmp_path: Path) -> None:
        for name in ("a.nc", "a.vrt", "a.jp2", "a.zzz", "a.zip", "a.gz"):
            (tmp_path / name).write_bytes(
                b"\x89HDF\r\n\x1a\n" * 9 if name == "a.nc" else b"<>\n\n<"
            )
            message = refusal(FileError, tmp_path / name)
            assert name in message
            assert len(message) < 500

    def test_without_rasterio_the_extra_is_named(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
        (tmp_path / "a.zzz").write_text("1 2 3")
        assert "terrain_lod[geo]" in refusal(MissingExtraError, tmp_path / "a.zzz")


class TestCrs:
    def test_one_that_proj_refuses_is_left_out(self, tmp_path: Path) -> None:
        path = tmp_path / "a.tif"
        path.write_bytes(mars_mercator(WHOLE))
        with pytest.warns(UserWarning, match=r"a CRS that PROJ refuses .*loaded without it"):
            ground = load(path)
        np.testing.assert_array_equal(ground.elevation, GRID)
        assert (ground.crs, ground.spacing) == (None, (600, 600))


def mars_mercator(values: np.ndarray) -> bytes:
    """Return a GeoTIFF in a Mercator projection whose latitude of origin nobody supports."""
    keys = [1, 1, 0, 18, 1024, 0, 1, 1, 1025, 0, 1, 1, 2048, 0, 1, 32767, 2050, 0, 1, 32767,
            2054, 0, 1, 9102, 2056, 0, 1, 32767, 2057, 34736, 1, 5, 2059, 34736, 1, 6,
            2061, 34736, 1, 7, 3072, 0, 1, 32767, 3074, 0, 1, 32767, 3075, 0, 1, 7,
            3076, 0, 1, 9001, 3080, 34736, 1, 1, 3081, 34736, 1, 0, 3082, 34736, 1, 2,
            3083, 34736, 1, 3, 3092, 34736, 1, 4]  # fmt: skip
    keys[3] = len(keys) // 4 - 1
    doubles = (-35.72, 129.45, 0.0, 0.0, 0.0, 3396190.0, 169.894, 0.0)
    samples = values.astype("<u2").tobytes()
    rows, columns = values.shape
    extra: list[tuple[int, int, bytes]] = [
        (33550, 12, struct.pack("<3d", 600, 600, 0)),
        (33922, 12, struct.pack("<6d", 0, 0, 0, -15648, -1817274, 0)),
        (34735, 3, struct.pack(f"<{len(keys)}H", *keys)),
        (34736, 12, struct.pack("<8d", *doubles)),
    ]
    plain = [(256, columns), (257, rows), (258, 16), (259, 1), (262, 1), (273, 0), (277, 1),
             (278, rows), (279, len(samples))]  # fmt: skip
    place = 8 + 2 + 12 * (len(plain) + len(extra)) + 4
    entries = b""
    for tag, value in plain:
        entries += struct.pack("<HHII", tag, 4, 1, place if tag == 273 else value)
    tail = samples
    for tag, kind, data in extra:
        size = 2 if kind == 3 else 8
        entries += struct.pack("<HHII", tag, kind, len(data) // size, place + len(tail))
        tail += data
    count = struct.pack("<H", len(plain) + len(extra))
    return b"II*\0" + struct.pack("<I", 8) + count + entries + bytes(4) + tail


def test_damage_stays_off_stderr(
    tmp_path: Path, route: str, capfd: pytest.CaptureFixture[str]
) -> None:
    noise = np.random.default_rng(0).integers(0, 999, (64, 64)).astype(np.int16)
    path = write_tiff(tmp_path / "a.tif", noise, compress="deflate")
    with Image.open(path) as image:
        start = image.tag_v2[273][0]
    data = bytearray(path.read_bytes())
    data[start : start + 40] = b"\xff" * 40
    path.write_bytes(data)
    assert "a.tif" in refusal(FileError, path)
    assert capfd.readouterr().err == ""
