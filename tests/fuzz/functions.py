"""Wrong arguments for everything public: each call ends well, or in one of the documented errors.

A :class:`Call` is something public with arguments that are good. Each of them in turn is replaced
by values that it was not made for (:func:`wrong_values`), and by the same value in another form
(:func:`same_values`), with which the call must come to the same as before.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import re
import shutil
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import MISSING, dataclass, field, fields
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import terrain_lod as tl
from fuzz.kind import require
from terrain_lod import curved
from terrain_lod.accessor import SurfaceAccessor
from terrain_lod.camera.camera_file import load_camera
from terrain_lod.viewer.mesh_settings import BezierSettings, CurvedSettings
from terrain_lod.viewer.terrain_settings import TerrainSettings

# results, which only the package makes; and errors
MADE_BY_US = (
    *("Achieved", "Continuity", "CrackReport", "Hits", "Pop", "Report", "ScreenError"),
    *("SweepReport", "TileAnalysis", "TileRecord", "TilesReport", "VerticalError", "Lod"),
    *("PromiseLod", "EdgeFactor", "Polyline", "DeviceArray", "DeviceMesh"),
    "NormalMap",
)
# for the package's own rooms, which hand on what is checked: kernels, events, records of arrays
OF_ROOMS = (
    *(
        "Device",
        "Device.array",
        "Device.record",
        "Device.timed",
        "Device.finish",
        "Patches",
        "Pattern",
    ),
    "Heightmap.with_crs",
    *("Camera.lifted", "Patches.largest_on_tiles"),
    *("Pattern.of", "Pattern.of_nothing", "Patches.on_tiles", "Decal.record"),
)
REFUSED = "refused: "
_LONGEST = 400  # characters of a message
_ADDRESS = re.compile("0x[0-9a-f]+")


class Reached(Exception):
    """The arguments were taken, and the work has begun."""


def begun(*_: object) -> None:
    raise Reached


@dataclass(frozen=True)
class Call:
    """Something public, with good arguments by name; those of `kept` are left as they are."""

    name: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    kept: tuple[str, ...] = ()
    use: Callable[[Any], object] = repr


@dataclass(frozen=True)
class Case:
    """A call with one argument replaced; `expected` is what it must come to, if that is known."""

    call: Call
    argument: str
    value: Any = field(repr=False)
    same: bool

    def __str__(self) -> str:
        return f"{self.call.name}({self.argument}={repr(self.value)[:60]})"

    def ended(self) -> str:
        """Return what the call comes to; `Wrong` where that is neither good nor documented."""
        value = self.value() if isinstance(self.value, _Anew) else self.value
        got = _ended(self.call, {self.argument: value})
        if self.same:
            good = _ended(self.call, {})
            require(got == good, f"{self}: {got[:200]}, in its usual form {good[:200]}")
        # a file's name may stand in a message, whatever is in it
        message = got.removeprefix(REFUSED).replace(str(value), "")
        if got.startswith(REFUSED):
            require("\n" not in message and 0 < len(message) < _LONGEST, f"{self}: {message!r}")
        return got


class _Anew:
    """A value that is used up, made for each call."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    def __call__(self) -> Any:
        return self._make()

    def __repr__(self) -> str:
        return "an iterator"


def _ended(call: Call, changed: dict[str, Any]) -> str:
    """Return what a call comes to, or the message of a documented error."""
    with warnings.catch_warnings():
        # of numbers that nobody looked at
        warnings.simplefilter("error", RuntimeWarning)
        warnings.simplefilter("error", DeprecationWarning)
        warnings.simplefilter("ignore", UserWarning)
        try:
            made = call.function(**(call.arguments | changed))
            return _ADDRESS.sub("", str(call.use(made)))
        except Reached:
            return "the work has begun"
        except tl.TerrainError as error:
            return f"{REFUSED}{error}"


def wrong_values(bench: Bench) -> tuple[Any, ...]:
    """Return values of every kind, most of which no argument was made for."""
    nan, inf = float("nan"), float("inf")
    scalars = (
        *(None, "seven", "", "x" * 5000, "a\nb", "\0", b"7", nan, inf, -inf, -1, 0, -0.5, 1e300),
        *(-1e300, 2**70, -(2**70), 1 + 2j, True, False, Decimal("nan"), Fraction(1, 3)),
        *(np.float64(nan), np.int8(-1), np.str_("seven"), np.complex64(1), np.datetime64("NaT")),
    )
    containers = (
        *({}, {"a": 1}, [], (), [1], (1, 2, 3, 4, 5, 6, 7), [[1, 2], [3]], [["a"]], [None, None]),
        *({1, 2}, range(3), slice(None), slice("a", None), (nan, nan), (inf, 0), ("a", "b", "c")),
        *([object()] * 3, [[1 + 2j] * 3], (2**70, 2**70), (1e300, -1e300, 1e300), ((1, 2), (3, 4))),
    )
    arrays = (
        *(np.array(nan), np.array("a"), np.array([]), np.empty((0, 3)), np.zeros((2, 2, 2, 2))),
        *(np.full((3, 3), nan), np.full((4, 4), inf), np.full((4, 3), 1e300), np.arange(9)),
        *(np.array([["a", "b"]]), np.array([None, {}]), np.ones((3, 3), complex), np.ones(3, bool)),
        *(np.zeros(3, "datetime64[s]"), np.zeros(3, [("x", "f4")]), np.ma.masked_all((3, 3))),
        *(np.full((5, 3), 2**40), np.full((5, 3), -1), np.zeros(1000), np.array([[1.5] * 3])),
    )
    others = (
        *(object(), dict, len, Ellipsis, NotImplemented, ValueError("x"), Path("nowhere/x.glb")),
        *(Path("."), Path("\0"), Path("x" * 5000), _Anew(lambda: iter([1, 2, 3]))),
        *(_Anew(lambda: (number for number in "abc")), tl.UniformLod, tl.UniformLod(3)),
        *(curved.UniformFactor(3), bench.ground, bench.mesh, bench.camera, bench.device, tl.Mesh),
        *(bench.terrain, np.random.default_rng(0)),
    )
    return (*scalars, *containers, *arrays, *others)


def same_values(value: Any) -> tuple[Any, ...]:
    """Return `value` in other forms that must serve as well."""
    match value:
        case bool():
            return (np.bool_(value),)
        case int():
            kinds = float, np.int64, np.int32, np.float32, np.array
            return *(kind(value) for kind in kinds), *([np.uint8(value)] if value < 256 else [])
        case float():
            short = (np.float32(value),) if float(np.float32(value)) == value else ()
            return np.float64(value), np.array(value), Fraction(value), *short
        case str():
            return (np.str_(value),)
        case Path():
            return str(value), np.str_(value)
        case tuple() if value and all(type(part) in (int, float) for part in value):
            return list(value), np.array(value), tuple(map(np.float64, value))
        case np.ndarray() if value.dtype.kind in "iuf":
            wide = np.zeros((*value.shape, 2), value.dtype)
            wide[..., 0] = value
            still = value.copy()
            still.setflags(write=False)
            forms = (
                *(np.asfortranarray(value), value.astype(value.dtype.newbyteorder(">"))),
                *(wide[..., 0], still, value.tolist(), np.ma.asarray(value)),
            )
            whole = value.dtype.kind != "f"
            return (*forms, value.astype(np.int64 if whole else np.float64))
    return ()


class Bench:
    """What calls are made with: small ground, and all that comes of it, in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        rows, columns = np.mgrid[:17, :17]
        heights = (8 * np.sin(rows / 3) * np.cos(columns / 4)).round(2)
        self.ground = tl.Heightmap(heights, spacing=2.0)
        self.detail = tl.Heightmap(np.eye(4) - 0.25, spacing=1.0)
        self.camera = tl.Camera((0.0, -40.0, 30.0), (16.0, -16.0, 0.0), size=(64, 48))
        self.device = tl.Device.open()
        self.terrain = tl.Terrain(self.ground, tile=4)
        self.mesh = self.terrain.mesh(self.camera, lod=tl.UniformLod(4), cull=False)
        self.vertices = np.float32([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 1]])
        self.normals = np.float32([[0, 0, 1]] * 4)
        self.triangles = np.int32([[0, 1, 2], [1, 3, 2]])
        self.textures = np.float32([[0, 0], [1, 0], [0, 1], [1, 1]])
        self.quad = tl.Mesh(self.vertices, self.normals, self.triangles, textures=self.textures)
        np.save(folder / "ground.npy", heights)
        self.quad.save(folder / "quad.ply")
        self.nets = np.float32(np.stack(np.meshgrid(*[range(4)] * 2, [0]), -1).reshape(1, 4, 4, 3))
        curved.save_bpt(self.nets, folder / "net.bpt")
        self.placed = tl.Heightmap(
            heights, spacing=2.0, origin=(5e5, 4e6), crs="EPSG:32632", units=("metre", "metre")
        )
        self.store = tl.build(self.ground, folder / "ground.tlod", chunk=16)
        self.stream = tl.open(self.store, memory="64MB")

    def calls(self) -> tuple[Call, ...]:
        """Return everything public, and what it is made with."""
        return tuple(
            made
            for some in (
                *(self._ground, self._pyramids, self._tiles, self._measures, self._meshes),
                *(self._subdivision, self._curves, self._values, self._inside),
            )
            for made in some()
        )

    def _ground(self) -> Iterator[Call]:
        ground, camera, folder, device = self.ground, self.camera, self.folder, self.device
        heights = np.float32(ground.heights)
        place = {"spacing": (2.0, 2.0), "origin": (1.0, 2.0), "base": 3.0}
        yield Call("Heightmap", tl.Heightmap, {
            "heights": heights, **place, "mask": np.eye(17) > 0, "crs": "EPSG:32632",
            "units": ("metre", "metre"), "name": "hill"}, use=self._use_ground)  # fmt: skip
        part = {"rows": slice(1, 4), "columns": slice(0, 2)}
        new = np.ones((3, 2))
        yield Call("Heightmap.with_elevations", ground.with_elevations, {**part, "elevations": new})
        yield Call("Heightmap.with_detail", ground.with_detail, {"detail": self.detail})
        yield Call("Heightmap.steps_of", ground.steps_of, {"detail": self.detail})
        yield Call("load", tl.load, {
            "path": folder / "ground.npy", "spacing": (2.0, 2.0), "nodata": 1.0,
            "window": (0, 0, 8, 8), "band": 1, "z_unit": "foot", "z_scale": 2.0})  # fmt: skip
        for name, value in (("height_range", (0.0, 1.0)), ("bounds", (0.0, 0.0, 9.0, 9.0)),
                            ("overview", 0), ("tile", (3, 1, 1))):  # fmt: skip
            yield Call("load", tl.load, {"path": folder / "ground.npy", name: value})
        yield Call("Heightmap.from_xarray", tl.Heightmap.from_xarray, {
            "array": ground.to_xarray(), "spacing": (2.0, 2.0), "nodata": 1.0,
            "window": (0, 0, 8, 8)}, use=self._use_ground)  # fmt: skip
        yield Call("Heightmap.to_xarray", lambda: ground.to_xarray().shape, {})
        yield Call("sample", lambda name: tl.sample(name), {"name": "topobathy"})
        yield Call("sample_names", tl.sample_names, {})
        yield Call("default_camera", tl.default_camera, {
            "ground": ground, "fov": 50.0, "size": (64, 48)})  # fmt: skip
        yield Call("Camera", tl.Camera, {
            "eye": (0.0, -9.0, 5.0), "target": (0.0, 0.0, 0.0), "up": (0.0, 0.0, 1.0), "fov": 50.0,
            "size": (64, 48), "near": 0.5, "far": 100.0, "height": 4.0})  # fmt: skip
        yield Call("Camera.planes", camera.planes, {"origin": (1.0, 2.0, 3.0)})
        yield Call("Camera.project", camera.project, {"points": np.float32([[1, 2, 3], [4, 5, 6]])})
        yield Call("Camera.view", camera.view, {"origin": (1.0, 2.0, 3.0)})
        yield Call("Terrain", tl.Terrain, {
            "ground": ground, "detail": self.detail, "tile": 4, "levels": 2, "plane": "corners",
            "device": device})  # fmt: skip
        yield Call("Terrain.update", lambda **what: tl.Terrain(ground, tile=4).update(**what), {
            **part, "heights": new})  # fmt: skip
        yield Call("Terrain.mesh", self.terrain.mesh, {
            "camera": camera, "lod": tl.ScreenErrorLod(2.0), "edge_rule": "edge",
            "partitioning": "fractional_odd", "cull": True})  # fmt: skip
        yield Call("Terrain.mesh", self.terrain.mesh, {
            "camera": camera, "steady": tl.Steady(), "heights": "ground"})  # fmt: skip
        yield Call("Terrain.mesh_on_device", self.terrain.mesh_on_device, {
            "camera": camera, "lod": tl.ScreenErrorLod(2.0), "edge_rule": "edge",
            "partitioning": "fractional_odd", "heights": "ground", "cull": True,
            "steady": tl.Steady()}, use=lambda mesh: mesh.vertices.shape)  # fmt: skip
        points, rays = np.float32([[1, -2], [3, -4]]), np.float32([[1, -2, 50], [3, -4, 50]])
        for name, asked in (
            ("Terrain", self.terrain),
            ("MeshQueries", tl.MeshQueries(self.mesh)),
            ("StreamingTerrain", self.stream),
        ):
            yield Call(f"{name}.height_at", asked.height_at, {"points": points})
            yield Call(f"{name}.cast", asked.cast, {
                "origins": rays, "directions": np.float32([[0, 0, -1], [0, 0.5, -1]])})  # fmt: skip
        yield Call("MeshQueries", tl.MeshQueries, {"mesh": self.mesh, "device": device})
        yield Call("analyse", tl.analyse, {
            "ground": ground, "tile": 4, "plane": "corners", "device": device})  # fmt: skip

    def _pyramids(self) -> Iterator[Call]:
        camera, device = self.camera, self.device
        # progress is a function of the caller's, as below
        new = self.folder / "new.tlod"
        work = {"path": new, "progress": begun, "chunk": 16}
        yield Call("build", self._anew(tl.build, "path", new), {
            "ground": self.ground, **work, "workers": None, "base": 2.0
        }, kept=("progress",))  # fmt: skip
        yield Call("build", self._anew(tl.build, "path", new), {
            "ground": self.folder / "ground.npy", **work, "spacing": (2.0, 2.0), "nodata": 1.0,
            "band": 1, "z_unit": "foot", "z_scale": 2.0}, kept=("progress",))  # fmt: skip
        yield Call("build", self._anew(tl.build, "path", new), {
            "ground": np.uint8(self.ground.heights + 9), **work, "spacing": 2.0,
            "height_range": (0.0, 1.0)}, kept=("progress",))  # fmt: skip
        held = {"memory": 64_000_000, "device": device}
        yield Call("open", tl.open, {"path": self.store, **held})
        yield Call("open", tl.open, {"path": self.store, "memory": "64MB"})
        yield Call("StreamingTerrain", tl.StreamingTerrain, {"store": self.stream.store, **held})
        yield Call("StreamingTerrain.mesh", self.stream.mesh, {
            "camera": camera, "lod": tl.ScreenErrorLod(2.0), "cull": True, "wait": True
        })  # fmt: skip
        yield Call("StreamingTerrain.ground_near", self.stream.ground_near, {"x": 1.0, "y": -2.0})
        yield Call("StreamingTerrain.update", self.stream.update, {
            "rows": slice(3, 5), "columns": slice(2, 6), "heights": np.zeros((2, 4), np.float32)
        })  # fmt: skip
        yield Call("Steady", tl.Steady, {"hysteresis": 0.5})

    def _tiles(self) -> Iterator[Call]:
        new = self.folder / "tiles"
        work = {"ground": self.placed, "folder": new, "zoom": 12, "progress": begun,
                "gzip": True, "crs": "EPSG:32632", "workers": None}  # fmt: skip
        for of_format in (
            {"format": "quantized-mesh", "error": 5.0, "scheme": "mercator", "borders": "skirts"},
            {"format": "3dtiles", "error": 5.0, "tiling": "explicit", "borders": "frozen"},
            {"format": "terrarium", "geoid": "ellipsoid"},
        ):
            yield Call("write_tiles", self._anew(tl.write_tiles, "folder", new), {
                **work, **of_format}, kept=("progress",))  # fmt: skip

    def _measures(self) -> Iterator[Call]:
        ground, camera, device = self.ground, self.camera, self.device
        against = {"mesh": self.mesh, "ground": ground, "device": device}
        seen = {**against, "camera": camera}
        yield Call("vertical_error", tl.vertical_error, {**against, "field": True})
        yield Call("patch_errors", tl.patch_errors, against)
        yield Call("bake_normals", tl.bake_normals, {
            "coarse": self.mesh, "fine": self.mesh, "size": (8, 6), "device": device
        })  # fmt: skip
        yield Call("normal_error", tl.normal_error, against)
        yield Call("screen_error", tl.screen_error, seen)
        yield Call("silhouette_error", tl.silhouette_error, seen)
        yield Call("pop_metric", tl.pop_metric, {
            "meshes": [self.mesh, self.mesh], "ground": ground, "cameras": [camera, camera],
            "device": device})  # fmt: skip
        yield Call("crack_report", tl.crack_report, {"mesh": self.mesh, "closed": False})
        # progress is a function of the caller's, whose own errors are the caller's
        work = {"ground": ground, "tile": 4, "device": device, "progress": begun}
        yield Call("report", tl.report, {
            "folder": self.folder / "report", **work, "camera": camera, "plane": "corners",
            "lod": tl.UniformLod(3), "distance": tl.DistanceLod(), "edge_rule": "min",
            "partitioning": "integer"}, kept=("progress",))  # fmt: skip
        yield Call("compare", tl.compare, {
            "folder": self.folder / "compare", **work, "views": 1}, kept=("progress",))  # fmt: skip
        looks = {"camera": camera, "style": "lod", "sun": (200.0, 40.0), "wireframe": True,
                 "height_range": (0.0, 9.0), "colour_range": (1.0, 9.0)}  # fmt: skip
        picture = self.folder / "picture.png"
        yield Call("render", tl.render, {
            "what": self.ground, "path": picture, "lod": tl.UniformLod(3), "device": device, **looks
        }, use=np.shape)  # fmt: skip
        yield Call("render", tl.render, {
            "what": self.ground, "texture": picture, "camera": camera}, kept=("what",), use=np.shape
        )  # fmt: skip
        yield Call("view", _viewed, {
            "what": ground, "camera": camera, "settings": {"mode": "lod"},
            "record": self.folder / "x.gif", "device": device})  # fmt: skip
        surface = SurfaceAccessor(self.mesh.to_pyvista())
        yield Call("accessor.vertical_error", surface.vertical_error, {"ground": ground})
        yield Call("accessor.save", surface.save, {"path": self.folder / "saved.ply"})

    def _meshes(self) -> Iterator[Call]:
        quad, folder, device = self.quad, self.folder, self.device
        corners = {"vertices": self.vertices, "normals": self.normals, "triangles": self.triangles}
        parts = {**corners, "origin": np.float32([1, 2, 3]), "crs": "EPSG:32632",
                 "timings": {"hull": 1.0}, "textures": self.textures}  # fmt: skip
        yield Call("Mesh", tl.Mesh, {**parts, "patches": None, "achieved": None}, use=_use_mesh)
        yield Call("CurvedMesh", curved.CurvedMesh, {
            **parts, "source_triangles": self.triangles,
            "points": np.uint32([[65536, 0], [0, 65536], [0, 0], [0, 0]]),
            "point_offsets": np.int64([0, 2, 4])}, use=lambda mesh: _use_mesh(mesh)
            + repr(mesh.interpolate(np.ones(4))))  # fmt: skip
        yield Call("Mesh.save", quad.save, {
            "path": folder / "saved.obj", "picture": np.zeros((2, 2, 3), np.uint8)})  # fmt: skip
        yield Call("Mesh.to_pyvista", lambda: quad.to_pyvista().n_points, {})
        yield Call("CurvedMesh.save", tl.pn_triangles(quad).save, {"path": folder / "saved.vtp"})
        yield Call("CurvedMesh.to_pyvista", lambda: tl.pn_triangles(quad).to_pyvista().n_points, {})
        yield Call("CurvedMesh.interpolate", tl.pn_triangles(quad).interpolate, {
            "values": np.float32([1, 2, 3, 4])})  # fmt: skip
        yield Call("load_mesh", tl.load_mesh, {"path": folder / "quad.ply"})
        split = np.full((2, 3), 3.0, np.float32)
        how = {"partitioning": "integer", "device": device}
        yield Call("pn_triangles", tl.pn_triangles, {
            "mesh": quad, "factor": split, "camera": self.camera, "normals": "linear",
            "sharp": 30.0, "cull": True, "back_faces": 0.5, **how})  # fmt: skip
        yield Call("pn_triangles", tl.pn_triangles, {
            "mesh": quad, "lod": curved.LengthFactor(), "camera": self.camera, "sharp": False,
            "partitioning": "semi_uniform"})  # fmt: skip
        yield Call("pn_triangles", tl.pn_triangles, {"mesh": quad, "factor": 3.0, "sharp": True})
        relief = np.float32(np.eye(4))
        yield Call("displace", tl.displace, {
            "mesh": quad, "heights": relief, "textures": self.textures, "factor": split,
            "scale": 2.0, "bias": 1.0, "camera": self.camera, "curved": True, **how})  # fmt: skip
        yield Call("displace", tl.displace, {
            "mesh": quad, "heights": relief, "lod": curved.LengthFactor(),
            "camera": self.camera})  # fmt: skip
        yield Call("variation_factors", curved.variation_factors, {
            "mesh": quad, "heights": relief, "textures": self.textures, "scale": 2.0,
            "tolerance": 0.5, "maximum": 8.0})  # fmt: skip
        yield Call("split_at_creases", curved.split_at_creases, {"mesh": quad, "degrees": 10.0})
        yield Call("bezier", curved.bezier, {"patches": self.nets, "factor": 3.0, **how})
        yield Call("bezier", curved.bezier, {"patches": folder / "net.bpt"})
        yield Call("load_bpt", curved.load_bpt, {"path": folder / "net.bpt"})
        yield Call("save_bpt", curved.save_bpt, {"nets": self.nets, "path": folder / "new.bpt"})
        yield Call("surface", lambda shape, **rest: curved.surface(shape, **rest), {
            "shape": "torus", "patches": (3, 2), "factor": 3.0, "tube": 0.5, **how})  # fmt: skip
        yield Call("curve", lambda shape, **rest: curved.curve(shape, **rest), {
            "shape": "helix", "pieces": 3, "factor": 3.0, "pitch": 0.5, **how})  # fmt: skip
        above, down = np.float32([[1, 1, 9], [2, 2, 9]]), np.float32([[0, 0, -1]])
        yield Call("shoot", curved.shoot, {
            "mesh": quad, "origins": above, "directions": down, "radius": 1.0, "scale": 0.5,
            "bias": 0.25, "device": device})  # fmt: skip
        yield Call("Decal", curved.Decal, {
            "point": (1.0, 1.0, 0.0), "normal": (0.0, 0.0, 1.0), "tangent": (1.0, 0.0, 0.0),
            "radius": 1.0, "scale": 0.5, "bias": 0.25})  # fmt: skip
        yield Call("dent", curved.dent, {
            "mesh": quad, "decals": curved.shoot(quad, above, down, 1.0), "depths": relief,
            "factor": 5.0, "elsewhere": 2.0, "curved": True, **how})  # fmt: skip
        yield Call("semi_uniform", tl.semi_uniform, {
            "levels": np.float32([[1, 2, 3]]), "maximum": 4, "keep_degenerate": False,
            "topology": "clockwise", "device": device})  # fmt: skip
        yield Call("tessellate", tl.tessellate, {
            "domain": "quad", "edge_factors": np.float32([[1, 2, 3, 4]]),
            "inside_factors": np.float32([[3, 4]]), "topology": "clockwise", **how})  # fmt: skip

    def _subdivision(self) -> Iterator[Call]:
        quad, device = self.quad, self.device
        control = {"vertices": self.vertices, "faces": [[0, 1, 3, 2]], "creases": [[0, 1]]}
        cage = curved.ControlMesh(**control)
        yield Call("ControlMesh", curved.ControlMesh, control)
        yield Call("ControlMesh.load", curved.ControlMesh.load, {
            "path": self.folder / "quad.ply", "creases": np.int32([[0, 1]])})  # fmt: skip
        yield Call("ControlMesh.refined", cage.refined, {})
        how = {"partitioning": "integer", "device": device}
        yield Call("catmull_clark", curved.catmull_clark, {"control": cage, "factor": 3.0, **how})
        yield Call("catmull_clark", curved.catmull_clark, {
            "control": self.folder / "quad.ply", "lod": curved.LengthFactor(),
            "camera": self.camera})  # fmt: skip
        yield Call("PosedMesh", curved.PosedMesh, {"mesh": quad, "factor": 3.0, **how})
        yield Call("PosedMesh.pose", curved.PosedMesh(quad, factor=3).pose, {
            "vertices": self.vertices, "normals": self.normals})  # fmt: skip

    def _curves(self) -> Iterator[Call]:
        line = np.float32([[[0, 0, 0], [1, 2, 0], [2, 0, 0]], [[2, 0, 0], [3, -2, 0], [4, 0, 1]]])
        yield Call("bezier_curve", curved.bezier_curve, {
            "points": line, "factor": 3.0, "partitioning": "integer", "device": self.device
        })  # fmt: skip
        yield Call("curve_continuity", curved.curve_continuity, {"points": line, "closed": True})
        yield Call("patch_continuity", curved.patch_continuity, {
            "nets": np.concatenate([self.nets, self.nets + np.float32([3, 0, 0])])})  # fmt: skip
        yield Call("b_spline", curved.b_spline, {
            "points": self.nets[0], "closed": (True, False)})  # fmt: skip

    def _values(self) -> Iterator[Call]:
        for module in (tl, curved):
            for name in module.__all__:
                kind = getattr(module, name)
                if name in MADE_BY_US or not hasattr(kind, "numbers"):
                    continue
                usual = {"factor": 3.0, "metres": 2.0, "triangles": 100}
                numbers = {
                    each.name: 2.0 if each.default in (None, MISSING) else each.default
                    for each in fields(kind)
                }
                # one of both
                numbers |= {each: usual[each] for each in usual if each in numbers}
                if name == "BudgetLod":
                    numbers["pixels"], numbers["metres"] = 2.0, 0.0
                if "far" in numbers:
                    numbers["far"] = 100.0
                yield Call(name, kind, numbers)
                made = kind(**numbers)
                yield Call(f"{name}.numbers", made.numbers, {})
                if hasattr(made, "parameters"):
                    of = {"scene": tl.Scene(10.0, 1.0, 15)} if module is tl else {"diagonal": 10.0}
                    yield Call(f"{name}.parameters", made.parameters, of)
        yield Call("Scene", tl.Scene, {"diagonal": 10.0, "rough_deviation": 1.0, "tile": 15})
        yield Call("Weighted", tl.Weighted, {
            "lod": tl.UniformLod(3), "horizon": 2.0, "silhouette": 2.0})  # fmt: skip
        number = {"default": 2.0, "low": 1.0, "high": 9.0, "step": 0.5, "help": "x", "unit": "m",
                  "shown": (0.25, 4.0), "logarithmic": True, "start": 2.0,
                  "required": False}  # fmt: skip
        yield Call("Number", tl.Number, number, use=lambda made: (
            made.checked("x", 2.0), made.slider(9.0), made.begin(9.0, 5)))  # fmt: skip
        yield Call("number", lambda **what: type(tl.number(**what)), number)
        made = tl.Number(**number)
        yield Call("Number.checked", made.checked, {"name": "x", "value": 2.0}, kept=("name",))
        yield Call("Number.slider", made.slider, {"diagonal": 9.0})
        yield Call("Number.begin", made.begin, {"diagonal": 9.0, "tile": 5})
        radius = {"radius": tl.Number(1.0)}
        header = {"header": "curved/surface/sphere.h", "numbers": radius}
        yield Call("ParametricSurface", curved.ParametricSurface, {
            **header, "closed": "u", "twisted": False})  # fmt: skip
        yield Call("ParametricCurve", curved.ParametricCurve, {
            "header": "curved/curve/helix.h", "closed": False, "numbers": {
                **radius, "pitch": tl.Number(0.5), "turns": tl.Number(3.0)}})  # fmt: skip
        for settings in (TerrainSettings, CurvedSettings, BezierSettings):
            begun_with = settings(diagonal=10.0)
            for choice in begun_with.choices:
                yield Call(f"{settings.__name__}.changed", begun_with.changed, {
                    "name": choice.name, "value": choice.values[-1]})  # fmt: skip
            for slider in begun_with.numbers:
                yield Call(f"{settings.__name__}.changed", begun_with.changed, {
                    "name": slider.name, "value": 3.0})  # fmt: skip
        yield Call("a camera of a file", self._from_file, {
            "eye": (0.0, -9.0, 5.0), "target": (0.0, 0.0, 0.0), "up": (0.0, 0.0, 1.0), "fov": 50.0,
            "size": (64, 48), "near": 0.5, "far": 100.0, "height": 4.0})  # fmt: skip

    def _inside(self) -> Iterator[Call]:
        device = self.device
        yield Call("devices", tl.devices, {})
        yield Call("Device.open", tl.Device.open, {"name": "0"})
        yield Call("Device.of", tl.Device.of, {"device": device})
        room = {"shape": 6, "dtype": "float32"}
        yield Call("Device.empty", device.empty, room)
        yield Call("Device.zeros", device.zeros, room)
        yield Call("Device.group_size", device.group_size, {"wanted": 64})
        yield Call("Device.runs", device.runs, {"count": 7})
        yield Call("Device.require", lambda what, nbytes: device.require(what, nbytes), {
            "what": "this", "nbytes": 100})  # fmt: skip
        yield Call("Device.require_doubles", device.require_doubles, {"what": "this"})
        yield Call("Device.kernel", lambda file, name, value: device.kernel(
            file, name, GROUP=value), {
            "file": "curved/bezier.cl", "name": "bezier", "value": 1}, kept=("value",))  # fmt: skip

    @staticmethod
    def _anew(function: Callable[..., Any], target: str, usual: Path) -> Callable[..., Any]:
        """Return a function that finds nothing in its usual folder."""

        def called(**arguments: Any) -> Any:
            if str(arguments[target]) == str(usual):
                shutil.rmtree(usual, ignore_errors=True)
            return function(**arguments)

        return called

    def _use_ground(self, ground: tl.Heightmap) -> str:
        return repr(ground) + repr(ground.elevation.sum()) + ground._repr_html_()[:99]

    def _from_file(self, **entry: Any) -> tl.Camera:
        path = self.folder / "camera.json"
        path.write_text(json.dumps(entry, default=_told))
        return load_camera(path)


def _told(value: object) -> object:
    if isinstance(value, Fraction):
        return float(value)
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else str(value)


def _use_mesh(mesh: tl.Mesh) -> str:
    with contextlib.suppress(tl.InputError):  # not sound, and said so
        tl.crack_report(mesh)
        mesh.to_pyvista()
    return repr(mesh) + mesh._repr_html_()


def _viewed(**arguments: Any) -> None:
    """Call `view` without a display: what it is given is looked at before that."""
    display = os.environ.pop("DISPLAY", None)
    try:
        tl.view(**arguments)
    except tl.GraphicsError:
        raise Reached from None
    finally:
        if display is not None:
            os.environ["DISPLAY"] = display


def cases(bench: Bench) -> Iterator[Case]:
    """Return every call with every one of its arguments replaced by every value."""
    values = wrong_values(bench)
    for call in bench.calls():
        for argument, good in call.arguments.items():
            if argument in call.kept:
                continue
            for value in values:
                yield Case(call, argument, value, same=False)
            for value in _within(good):
                yield Case(call, argument, value, same=False)
            for value in same_values(good):
                yield Case(call, argument, value, same=True)


def _within(good: Any) -> Iterator[Any]:
    """Return a value of several parts with one of them replaced."""
    parts = (None, "seven", float("nan"), -1, 2**70, 1 + 2j, [1], object())
    if isinstance(good, tuple | list) and good:
        for part in parts:
            yield type(good)([*good[:-1], part])
    if isinstance(good, dict):
        for key in good:
            for part in parts:
                yield {**good, key: part}
        yield {1: 2}
    if isinstance(good, slice):
        for part in parts:
            yield slice(good.start, part)
            yield slice(good.start, good.stop, part)


@cache
def _every_case() -> tuple[tempfile.TemporaryDirectory[str], list[Case]]:
    folder = tempfile.TemporaryDirectory(prefix="terrain_lod-bench-")
    return folder, list(cases(Bench(Path(folder.name))))


def trial(chance: random.Random, folder: Path) -> None:
    _, every = _every_case()
    with contextlib.chdir(folder):
        ended = chance.choice(every).ended()
    if ended.startswith(REFUSED):
        raise tl.InputError("said in one line")


def covered() -> set[str]:
    """Return the names of everything public that takes arguments."""
    return {
        name
        for module in (tl, curved)
        for public in module.__all__
        for name in _callables(public, getattr(module, public))
    }


def _callables(public: str, value: Any) -> Iterator[str]:
    if isinstance(value, type) and not issubclass(value, Exception):
        yield public
        for name in dir(value):
            if not name.startswith("_") and callable(getattr(value, name)):
                yield f"{public}.{name}"
    elif callable(value) and not isinstance(value, type):
        yield public
