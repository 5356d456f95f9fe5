"""Odd rasters of every kind, each made by a function of a folder."""

from __future__ import annotations

import gzip
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
import rasterio
from rasterio.enums import ColorInterp, Resampling
from rasterio.shutil import copy
from rasterio.transform import Affine

from support.rasters import write_tiff

# 40 x 32 samples, no two alike
HILLS: Final = np.round(900 + 70 * np.sin(np.arange(40) / 6)[:, None] + np.arange(32) * 3.25, 2)
WHOLE: Final = HILLS.astype(np.int16)
# thirds of an arc-second in the Alps; the same in grads
DEGREES: Final = Affine(1 / 3600, 0, 7.5, 0, -1 / 3600, 46.5)
GRADS: Final = Affine(1e-3, 0, 5.0, 0, -1e-3, 51.0)
FEET: Final = Affine(25, 0, 980_000, 0, -25, 200_000)
# 48 degrees north on the map of the web
WEB: Final = Affine(38.2, 0, 1_000_000, 0, -38.2, 6_100_000)

Maker = Callable[[Path], Path]


def tiff(values: np.ndarray, **options: Any) -> Maker:
    """Return what writes a GeoTIFF; options as `write_tiff`'s, and what is set afterwards."""
    after = {key: options.pop(key) for key in ("units", "scales", "offsets", "descriptions",
             "colorinterp") if key in options}  # fmt: skip
    overviews, mask = options.pop("overviews", ()), options.pop("own_mask", None)

    def make(folder: Path) -> Path:
        path = write_tiff(folder / "odd.tif", values, **options)
        with rasterio.open(path, "r+") as file:
            for key, value in after.items():
                setattr(file, key, value)
            if mask is not None:
                file.write_mask(mask)
            if overviews:
                file.build_overviews(overviews, Resampling.average)
        return path

    return make


def translated(driver: str, ending: str, values: np.ndarray = WHOLE, **options: Any) -> Maker:
    """Return what writes a file of another kind of GDAL's."""
    creation = options.pop("creation", {})

    def make(folder: Path) -> Path:
        source = write_tiff(folder / "source.tif", values, **options)
        copy(source, folder / f"odd.{ending}", driver=driver, **creation)
        source.unlink()
        return folder / f"odd.{ending}"

    return make


def copied(driver: str, ending: str, make: Maker) -> Maker:
    """Return what writes a file of another kind of GDAL's, from a GeoTIFF."""

    def made(folder: Path) -> Path:
        source = make(folder).rename(folder / "source.tif")
        copy(source, folder / f"odd.{ending}", driver=driver)
        source.unlink()
        return folder / f"odd.{ending}"

    return made


def packed(ending: str) -> Maker:
    def make(folder: Path) -> Path:
        source = write_tiff(folder / "source.tif", WHOLE)
        path = folder / f"odd.tif.{ending}"
        if ending == "gz":
            path.write_bytes(gzip.compress(source.read_bytes()))
        else:
            with zipfile.ZipFile(path, "w") as archive:
                archive.write(source, "inside/dem.tif")
                archive.writestr("inside/readme.txt", "heights")
        source.unlink()
        return path

    return make


def renamed(make: Maker, name: str) -> Maker:
    return lambda folder: make(folder).rename(folder / name)


def virtual(folder: Path) -> Path:
    write_tiff(folder / "source.tif", WHOLE)
    with rasterio.open(folder / "source.tif") as file:
        text = (
            f'<VRTDataset rasterXSize="{file.width}" rasterYSize="{file.height}">'
            f"<SRS>EPSG:32632</SRS><GeoTransform>500000, 30, 0, 4000000, 0, -20</GeoTransform>"
            '<VRTRasterBand dataType="Int16" band="1"><NoDataValue>900</NoDataValue>'
            '<SimpleSource><SourceFilename relativeToVRT="1">source.tif</SourceFilename>'
            "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
        )
    (folder / "odd.vrt").write_text(text)
    return folder / "odd.vrt"


def text_grid(header: str, values: np.ndarray = HILLS, crs: str | None = None) -> Maker:
    """Return what writes an ESRI ASCII grid."""

    def make(folder: Path) -> Path:
        lines = "\n".join(" ".join(f"{value:.10g}" for value in row) for row in values)
        rows, columns = values.shape
        (folder / "odd.asc").write_text(f"ncols {columns}\nnrows {rows}\n{header}\n{lines}\n")
        if crs:
            wkt = rasterio.CRS.from_string(crs).to_wkt(version="WKT1_ESRI")
            (folder / "odd.prj").write_text(wkt)
        return folder / "odd.asc"

    return make


def holed(dtype: str, nodata: float) -> np.ndarray:
    values = HILLS.astype(dtype)
    values[3:7, 5:9] = nodata
    return values


def with_alpha(dtype: str, opaque: float) -> np.ndarray:
    alpha = np.full(HILLS.shape, opaque)
    alpha[:4] = 0
    return np.stack([HILLS, alpha]).astype(dtype)


ALPHA: Final = [ColorInterp.gray, ColorInterp.alpha]
FLOAT: Final = HILLS.astype(np.float32)
GREY: Final = (WHOLE // 5).astype(np.uint8)
CELL: Final = Affine(30, 0, 500_000, 0, -30, 4_000_000)
FLIPPED: Final = Affine(30, 0, 500_000, 0, 30, 3_000_000)
LOWEST: Final = float(np.finfo(np.float32).min)
LCC_FEET: Final = "EPSG:2263"
MARS: Final = "+proj=longlat +R=3396190 +no_defs"

# name: what makes it, and what `load` is told besides
ODD: Final[dict[str, tuple[Maker, dict[str, Any]]]] = {
    # kinds of numbers
    **{f"dtype {dtype}": (tiff(HILLS.astype(dtype)), {}) for dtype in
       ("uint16", "int16", "uint32", "int32", "float32", "float64", "int64", "uint64")},
    "dtype int8": (tiff((HILLS / 10).astype(np.int8)), {}),
    "twelve bits": (tiff(WHOLE.astype(np.uint16), nbits=12), {}),
    "24 bits": (tiff(WHOLE.astype(np.uint32), nbits=24), {}),
    "half floats": (tiff(FLOAT, nbits=16), {}),
    "floats of 24 bits": (tiff(FLOAT, nbits=24), {}),
    "big-endian": (tiff(FLOAT, ENDIANNESS="BIG"), {}),
    "bigtiff": (tiff(FLOAT, BIGTIFF="YES"), {}),
    "deflate, predictor 3": (tiff(FLOAT, compress="deflate", predictor=3), {}),
    "lzw, predictor 2": (tiff(WHOLE, compress="lzw", predictor=2), {}),
    "zstd": (tiff(FLOAT, compress="zstd"), {}),
    "lerc": (tiff(FLOAT, compress="lerc"), {}),
    "lerc and zstd": (tiff(FLOAT, compress="lerc_zstd"), {}),
    "lzma": (tiff(FLOAT, compress="lzma"), {}),
    "packbits": (tiff(WHOLE, compress="packbits"), {}),
    "JPEG in tiles": (tiff(GREY, compress="JPEG", tiled=True, blockxsize=16, blockysize=16), {}),
    "white is zero": (tiff(GREY, photometric="MINISWHITE"), {}),
    "tiled": (tiff(FLOAT, tiled=True, blockxsize=16, blockysize=16), {}),
    "strips of one row": (tiff(FLOAT, blockysize=1), {}),
    "sparse": (tiff(np.where(HILLS > 990, HILLS, 0), SPARSE_OK=True), {}),
    # no data
    "nodata -9999": (tiff(holed("float32", -9999), nodata=-9999), {}),
    "nodata -32768": (tiff(holed("int16", -32768), nodata=-32768), {}),
    "nodata 0 of uint16": (tiff(holed("uint16", 0), nodata=0), {}),
    "nodata 65535": (tiff(holed("uint16", 65535), nodata=65535), {}),
    "nodata least float32": (tiff(holed("float32", LOWEST), nodata=LOWEST), {}),
    "nodata least float64": (tiff(holed("float64", -1.7976931348623157e308),
                                  nodata=-1.7976931348623157e308), {}),
    "nodata 1e20 of float64": (tiff(holed("float64", 1e20), nodata=1e20), {}),
    "nodata NaN": (tiff(holed("float32", np.nan), nodata=np.nan), {}),
    "NaN undeclared": (tiff(holed("float32", np.nan)), {}),
    "nodata nowhere": (tiff(FLOAT, nodata=-9999), {}),
    "mask of its own": (tiff(FLOAT, own_mask=HILLS > 950), {}),
    "nodata and a fraction": (tiff(holed("float32", -3.5), nodata=-3.5), {}),
    # alpha
    **{f"alpha {dtype}": (tiff(with_alpha(dtype, opaque), colorinterp=ALPHA, ALPHA="YES"), {})
       for dtype, opaque in (("uint16", 65535), ("int16", 255), ("int32", 255), ("float32", 1.0),
                             ("float64", 255.0))},
    "alpha and nodata": (tiff(with_alpha("uint16", 65535), colorinterp=ALPHA, ALPHA="YES",
                              nodata=900), {}),
    # bands
    "second of two bands": (tiff(np.stack([HILLS * 0, HILLS])), {"band": 2}),
    "third of three, with names": (tiff(np.stack([FLOAT, FLOAT + 1, FLOAT + 2]),
                                        descriptions=["slope", "aspect", "dem"]), {"band": 3}),
    "bands by pixel": (tiff(np.stack([WHOLE, WHOLE + 1]), interleave="pixel"), {"band": 2}),
    "bands by plane": (tiff(np.stack([WHOLE, WHOLE + 1]), interleave="band"), {"band": 1}),
    # packed numbers
    "scale and offset": (tiff(WHOLE, scales=(0.5,), offsets=(1000.0,)), {}),
    "scale, offset and nodata": (tiff(holed("int16", -1), nodata=-1, scales=(0.1,),
                                      offsets=(-5.0,)), {}),
    "scale alone": (tiff(WHOLE, scales=(0.01,)), {}),
    "depths": (tiff(WHOLE, scales=(-1.0,)), {}),
    # units
    "feet in degrees": (tiff(FLOAT, crs="EPSG:4326", transform=DEGREES, units=("ft",)), {}),
    "survey feet in degrees": (tiff(FLOAT, crs="EPSG:4269", transform=DEGREES,
                                    units=("US survey foot",)), {}),
    "feet in metres": (tiff(FLOAT, units=("ft",)), {}),
    "fathoms": (tiff(FLOAT, units=("fathom",)), {}),
    "kilometres": (tiff(FLOAT / 1000, units=("km",)), {}),
    "centimetres": (tiff(WHOLE, units=("cm",)), {}),
    "metres in survey feet": (tiff(FLOAT, crs=LCC_FEET, transform=FEET, units=("metre",)), {}),
    "survey feet in survey feet": (tiff(FLOAT, crs=LCC_FEET, transform=FEET,
                                        units=("US survey foot",)), {}),
    "vertical CRS in metres": (tiff(FLOAT, crs="EPSG:2263+5703", transform=FEET), {}),
    "vertical CRS in survey feet": (tiff(FLOAT, crs="EPSG:2263+6360", transform=FEET), {}),
    "vertical CRS in feet, UTM": (tiff(FLOAT, crs="EPSG:32613+8228"), {}),
    "international feet": (tiff(FLOAT, crs="EPSG:2222", transform=Affine(10, 0, 7e5, 0, -10, 9e5),
                                units=("foot",)), {}),
    "grads": (tiff(FLOAT, crs="EPSG:4807", transform=GRADS), {}),
    "degrees of Mars": (tiff(FLOAT, crs=MARS, transform=DEGREES), {}),
    # places
    "map of the web": (tiff(FLOAT, crs="EPSG:3857", transform=WEB), {}),
    "map of the web, its units": (tiff(FLOAT, crs="EPSG:3857", transform=WEB), {"spacing": "map"}),
    "plate carree": (tiff(FLOAT, crs="EPSG:4087", transform=Affine(30, 0, 1e5, 0, -30, 6e6)), {}),
    "polar stereographic": (tiff(FLOAT, crs="EPSG:3413",
                                 transform=Affine(30, 0, 1e5, 0, -30, -1e6)), {}),
    "samples on points": (tiff(FLOAT, tags={"AREA_OR_POINT": "Point"}), {}),
    "rows from the south": (tiff(FLOAT, transform=FLIPPED), {}),
    "rows from the south, holes": (tiff(holed("float32", -9999), transform=FLIPPED, nodata=-9999),
                                   {}),
    "a hair of rotation": (tiff(FLOAT, transform=Affine(30, 1e-9, 5e5, -1e-9, -30, 4e6)), {}),
    "no CRS": (tiff(FLOAT, crs=None), {}),
    "south of the equator": (tiff(FLOAT, crs="EPSG:4326",
                                  transform=Affine(1e-3, 0, -70, 0, -1e-3, -33)), {}),
    "longitude 0 to 360": (tiff(FLOAT, crs="EPSG:4326",
                                transform=Affine(1e-3, 0, 290, 0, -1e-3, -33)), {}),
    # overviews and parts
    "first overview": (tiff(FLOAT, overviews=[2, 4]), {"overview": 0}),
    "second overview": (tiff(FLOAT, overviews=[2, 4]), {"overview": 1}),
    "overview with holes": (tiff(holed("float32", -9999), nodata=-9999, overviews=[2]),
                            {"overview": 0}),
    "window": (tiff(FLOAT), {"window": (3, 5, 7, 9)}),
    "window from the south": (tiff(FLOAT, transform=FLIPPED), {"window": (3, 5, 7, 9)}),
    "bounds": (tiff(FLOAT, transform=CELL), {"bounds": (500_090, 3_999_400, 500_600, 3_999_910)}),
    "bounds beyond": (tiff(FLOAT, transform=CELL), {"bounds": (0, 0, 500_600, 3_999_910)}),
    "bounds in degrees": (tiff(FLOAT, crs="EPSG:4326", transform=DEGREES),
                          {"bounds": (7.5, 46.495, 7.505, 46.5)}),
    "window of an overview": (tiff(FLOAT, overviews=[2]), {"overview": 0, "window": (2, 3, 9, 8)}),
    # other doors
    "ENVI": (translated("ENVI", "dat"), {}),
    "ERDAS": (translated("HFA", "img"), {}),
    "ESRI .bil": (translated("EHdr", "bil"), {}),
    "Surfer text": (translated("GSAG", "grd"), {}),
    "Surfer 6": (translated("GSBG", "grd"), {}),
    "Surfer 7": (translated("GS7BG", "grd"), {}),
    "SAGA": (translated("SAGA", "sdat"), {}),
    "Idrisi": (translated("RST", "rst"), {}),
    "PCRaster": (translated("PCRaster", "map", FLOAT, crs="EPSG:32632", transform=CELL), {}),
    "netCDF": (translated("netCDF", "nc"), {}),
    "netCDF, packed": (copied("netCDF", "nc", tiff(holed("int16", -1), nodata=-1, scales=(0.1,),
                                                   offsets=(-5.0,))), {}),
    "PNG, alpha of 16 bits": (copied("PNG", "png", tiff(with_alpha("uint16", 65535), ALPHA="YES",
                                                        colorinterp=ALPHA)), {}),
    "PNG, nodata beside it": (copied("PNG", "png", tiff(holed("uint16", 0), nodata=0)), {}),
    "GeoPackage": (translated("GPKG", "gpkg", FLOAT, crs="EPSG:32632", transform=CELL), {}),
    "MRF": (translated("MRF", "mrf"), {}),
    "PDS4": (translated("PDS4", "xml", FLOAT), {}),
    "ERMapper": (translated("ERS", "ers", FLOAT), {}),
    "PCIDSK": (translated("PCIDSK", "pix", FLOAT), {}),
    "ZMap": (translated("ZMap", "dat", FLOAT), {}),
    "GRIB": (translated("GRIB", "grib"), {}),
    "GTX": (translated("GTX", "gtx", FLOAT, crs="EPSG:4326", transform=DEGREES), {}),
    "USGS DEM": (translated("USGSDEM", "dem", transform=CELL), {}),
    "NITF": (translated("NITF", "ntf"), {}),
    "JPEG 2000": (translated("JP2OpenJPEG", "jp2",
                             creation={"REVERSIBLE": "YES", "QUALITY": "100"}), {}),
    "VTP .bt": (translated("BT", "bt"), {}),
    "XYZ": (translated("XYZ", "xyz", crs=None), {}),
    "R": (translated("RRASTER", "grd"), {}),
    "cloud-optimised": (translated("COG", "tif"), {}),
    "a virtual raster": (virtual, {}),
    "zipped": (packed("zip"), {}),
    "gzipped": (packed("gz"), {}),
    "TIFF called .dem": (renamed(tiff(WHOLE), "odd.dem"), {}),
    "TIFF called .png": (renamed(tiff(WHOLE), "odd.png"), {}),
    "TIFF called nothing": (renamed(tiff(WHOLE), "odd"), {}),
    # grids of text
    ".asc": (text_grid("xllcorner 5e5\nyllcorner 4e6\ncellsize 30"), {}),
    ".asc, centres": (text_grid("xllcenter 5e5\nyllcenter 4e6\ncellsize 30"), {}),
    ".asc, oblong": (text_grid("xllcorner 5e5\nyllcorner 4e6\ndx 30\ndy 20"), {}),
    ".asc, nodata": (text_grid("xllcorner 5e5\nyllcorner 4e6\ncellsize 30\nNODATA_value -9999",
                               holed("float64", -9999)), {}),
    ".asc, least float32": (text_grid("xllcorner 5e5\nyllcorner 4e6\ncellsize 30\n"
                                      "NODATA_value -3.402823e+38", holed("float64", LOWEST)), {}),
    ".asc in feet": (text_grid("xllcorner 980000\nyllcorner 200000\ncellsize 25", crs=LCC_FEET),
                     {}),
    ".asc in degrees": (text_grid("xllcorner 7\nyllcorner 46\ncellsize 0.001", crs="EPSG:4326"),
                        {}),
}  # fmt: skip
