"""Ways to make many triangles of few on the device, with and without a tessellator.

All of them make the same surface, the PN-triangles of a mesh at one odd level, for every copy of
it. They differ in what they keep between frames, what they need while they draw one, and the time:
``amplification.py`` compares them.

===========  =====================================================================================
``fixed``    a work-item a triangle makes all sub-triangles; a kernel built for the level
``direct``   the same, one kernel for any level
``borders``  two passes: emitters first, each of which then makes a border of sub-triangles
``quads``    the same, each emitter makes two sub-triangles
``stored``   made once, by borders; each frame places what is stored
``indexed``  the tessellator: factors, indexed triangles, the domain stage
``passed``   the same, and a stage after it that forwards the triangles one by one
===========  =====================================================================================

After the six cases of a thesis that compares PN-triangles by geometry shader with those by the
fixed-function tessellator. As there, sub-triangles find their coordinates in a table that the
tessellator made once, so that the surfaces are equal.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from terrain_lod.arguments import one_of, whole
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.pn import DevicePatchMesh, evaluate_on_device, nets_on_device
from terrain_lod.device.device import Device, DeviceArray, Kernel
from terrain_lod.errors import InputError
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.mesh.soundness import require_sound
from terrain_lod.tessellation.factors import DeviceFactors
from terrain_lod.tessellation.tessellator import tessellate_device

_HERE: Final = Path(__file__).parent
_GROUP: Final = 64
_LARGEST_LEVEL: Final = 63


@dataclass(frozen=True, eq=False)
class Scene:
    """A mesh of T triangles on the device, and where its K copies stand.

    Attributes
    ----------
    mesh : DevicePatchMesh
    transforms : DeviceArray, (K, 3, 4) float32
        A rotation and, in the last column, a shift.
    """

    mesh: DevicePatchMesh
    transforms: DeviceArray

    @classmethod
    def upload(cls, mesh: Mesh, transforms: npt.ArrayLike | None, device: Device) -> Scene:
        """Copy `mesh` to the device, and its transforms; by default it stands where it is."""
        rows = np.eye(3, 4)[None] if transforms is None else np.asarray(transforms)
        if rows.ndim != 3 or rows.shape[1:] != (3, 4) or not np.isfinite(rows).all():
            raise InputError(f"expected finite transforms of shape (K, 3, 4), got {rows.shape}")
        patches = DevicePatchMesh.upload(mesh.vertices, mesh.normals, Adjacency.of(mesh), device)
        return cls(patches, device.array(rows.astype(np.float32)))

    @property
    def device(self) -> Device:
        return self.mesh.device

    @property
    def copies(self) -> int:
        return self.transforms.shape[0]

    @property
    def patches(self) -> int:
        """Triangles of all copies."""
        return self.copies * self.mesh.count

    def nets(self) -> DeviceArray:
        """Return the control nets of every copy; (K T, 16, 3) float32."""
        device, nets = self.device, nets_on_device(self.mesh)
        placed = device.empty((self.patches, *nets.shape[1:]), np.float32)
        _kernel(device, "place_nets")(
            (self.patches,),
            (_GROUP,),
            triangles=self.mesh.count,
            copies=self.copies,
            transforms=self.transforms,
            nets=nets,
            placed_nets=placed,
        )
        return placed


@dataclass(frozen=True, eq=False)
class Frame:
    """What is drawn once.

    Attributes
    ----------
    positions, normals : DeviceArray, (N, 3) float32
    indices : DeviceArray, (M, 3) int32, or None
        None where every three vertices are a triangle.
    working : int
        Bytes that were needed on the way, besides these and what is kept.
    """

    positions: DeviceArray
    normals: DeviceArray
    indices: DeviceArray | None
    working: int

    @property
    def nbytes(self) -> int:
        """Bytes of the triangles themselves."""
        indices = 0 if self.indices is None else self.indices.nbytes
        return self.positions.nbytes + self.normals.nbytes + indices


@dataclass(frozen=True, eq=False)
class Amplifier:
    """A way, made ready for a scene and a level.

    Attributes
    ----------
    kept : int
        Bytes that stay on the device between frames, besides the scene.
    draw : callable
        Makes a frame.
    """

    kept: int
    draw: Callable[[], Frame]


def triangles_of(level: int) -> int:
    """Return how many sub-triangles an odd level has: rings of three strips, and the middle."""
    return (3 * level * level - 1) // 2


def emitters_per_triangle(level: int, *, quads: bool) -> int:
    """Return how many emitters stand for them: one a border or one a quad, and the middle's."""
    rings = (level - 1) // 2
    return 1 + (3 * rings * (level - rings) if quads else 3 * rings)


def amplify(
    mesh: Mesh,
    level: int = 5,
    *,
    way: str = "indexed",
    transforms: npt.ArrayLike | None = None,
    device: Device | None = None,
) -> Mesh:
    """Return copies of a mesh as PN-triangles of one odd level, made one of the ways above.

    Parameters
    ----------
    mesh : Mesh
        Sound, with unit normals.
    level : int, optional
        Segments along every edge: 1, 3, ... 63.
    way : str, optional
        One of :data:`WAYS`.
    transforms : (K, 3, 4) array_like, optional
        Where the copies stand: a rotation and, in the last column, a shift.
    device : Device, optional

    Returns
    -------
    Mesh
        Triangles in the same order for every way, copy by copy. Vertices are shared within a patch
        where the way is ``indexed``, else each triangle has its own.

    Raises
    ------
    InputError
        If the level is even, a word unknown, or the mesh broken or empty.
    DeviceMemoryError
        If the device cannot hold the triangles.
    """
    one_of("way", way, WAYS)
    if whole("level", level, 1, _LARGEST_LEVEL) % 2 == 0:
        raise InputError(f"expected an odd level, got {level}")
    if not len(mesh.triangles):
        raise InputError("expected triangles to amplify, got an empty mesh")
    require_sound(mesh.vertices, mesh.triangles)
    scene = Scene.upload(mesh, transforms, device or Device.open())
    frame = WAYS[way](scene, level).draw()
    count = scene.patches * triangles_of(level)
    triangles = (
        np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
        if frame.indices is None
        else frame.indices.host()
    )
    return Mesh(
        frame.positions.host(), frame.normals.host(), triangles, origin=mesh.origin, crs=mesh.crs
    )


# the ways


def _direct(scene: Scene, level: int, *, fixed: bool) -> Amplifier:
    points = _table(scene.device, level)
    defines = {"LEVEL": level} if fixed else {}
    kernel = _kernel(scene.device, "direct", **defines)

    def draw() -> Frame:
        positions, normals = _room(scene.device, scene.patches, level)
        nets = scene.nets()
        kernel(
            (scene.patches,),
            (_GROUP,),
            patches=scene.patches,
            level=level,
            nets=nets,
            points=points,
            positions=positions,
            normals=normals,
        )
        return Frame(positions, normals, None, nets.nbytes)

    return Amplifier(points.nbytes, draw)


def _emitted(scene: Scene, level: int, *, quads: bool) -> Amplifier:
    device, points = scene.device, _table(scene.device, level)
    each = emitters_per_triangle(level, quads=quads)
    count = scene.patches * each
    device.require(f"{count} emitters", 16 * count)
    # first pass: once, as long as the level stays
    records = device.empty((count, 4), np.int32)
    _kernel(device, "emitters", QUADS=int(quads))(
        (scene.patches,),
        (_GROUP,),
        patches=scene.patches,
        level=level,
        each=each,
        records=records,
    )
    kernel = _kernel(device, "emit", QUADS=int(quads))

    def draw() -> Frame:
        positions, normals = _room(device, scene.patches, level)
        nets = scene.nets()
        kernel(
            (count,),
            (_GROUP,),
            count=count,
            level=level,
            records=records,
            nets=nets,
            points=points,
            positions=positions,
            normals=normals,
        )
        return Frame(positions, normals, None, nets.nbytes)

    return Amplifier(points.nbytes + records.nbytes, draw)


def _stored(scene: Scene, level: int) -> Amplifier:
    device = scene.device
    still = Scene(scene.mesh, device.array(np.eye(3, 4, dtype=np.float32)[None]))
    stored = _emitted(still, level, quads=False).draw()
    kernel = _kernel(device, "place")

    def draw() -> Frame:
        positions, normals = _room(device, scene.patches, level)
        kernel(
            (stored.positions.shape[0],),
            (_GROUP,),
            vertices=stored.positions.shape[0],
            copies=scene.copies,
            transforms=scene.transforms,
            stored_positions=stored.positions,
            stored_normals=stored.normals,
            positions=positions,
            normals=normals,
        )
        return Frame(positions, normals, None, 0)

    return Amplifier(stored.nbytes, draw)


def _tessellated(scene: Scene, level: int) -> Amplifier:
    device = scene.device
    factors = _factors(device, scene.patches, level)

    def draw() -> Frame:
        nets = scene.nets()
        pattern = tessellate_device(
            "triangle", factors.edge, factors.inside, "fractional_odd", clockwise=True
        )
        vertices = evaluate_on_device(nets, pattern)
        offsets = pattern.point_offsets.nbytes + pattern.primitive_offsets.nbytes
        working = nets.nbytes + pattern.points.nbytes + offsets
        return Frame(vertices.positions, vertices.normals, pattern.primitives, working)

    return Amplifier(factors.edge.nbytes + factors.inside.nbytes, draw)


def _passed(scene: Scene, level: int) -> Amplifier:
    tessellator = _tessellated(scene, level)
    kernel = _kernel(scene.device, "pass_through")

    def draw() -> Frame:
        frame = tessellator.draw()
        assert frame.indices is not None
        positions, normals = _room(scene.device, scene.patches, level)
        kernel(
            (frame.indices.size,),
            (_GROUP,),
            corners=frame.indices.size,
            indices=frame.indices,
            vertex_positions=frame.positions,
            vertex_normals=frame.normals,
            positions=positions,
            normals=normals,
        )
        return Frame(positions, normals, None, frame.working + frame.nbytes)

    return Amplifier(tessellator.kept, draw)


WAYS: Final[dict[str, Callable[[Scene, int], Amplifier]]] = {
    "fixed": partial(_direct, fixed=True),
    "direct": partial(_direct, fixed=False),
    "borders": partial(_emitted, quads=False),
    "quads": partial(_emitted, quads=True),
    "stored": _stored,
    "indexed": _tessellated,
    "passed": _passed,
}


# what they share


def _kernel(device: Device, name: str, **defines: int) -> Kernel:
    fixed = {"STRIP": f'"{_HERE / "strip.h"}"', "LANES": 1, "LINEAR_NORMALS": 0, "QUADS": 0}
    return device.kernel(str(_HERE / "ways.cl"), name, **{**fixed, **defines})


def _room(device: Device, patches: int, level: int) -> tuple[DeviceArray, DeviceArray]:
    """Return arrays for the corners of all sub-triangles, or refuse with the bytes."""
    count = patches * triangles_of(level)
    device.require(f"{count} triangles", 36 * count, 36 * count)
    shape = (3 * count, 3)
    return device.empty(shape, np.float32), device.empty(shape, np.float32)


def _factors(device: Device, patches: int, level: int) -> DeviceFactors:
    edge, inside = (device.empty((patches, width), np.float32) for width in (3, 1))
    return DeviceFactors(edge.fill(level), inside.fill(level))


def _table(device: Device, level: int) -> DeviceArray:
    """Return the coordinates of one patch's points, as the tessellator has them."""
    factors = _factors(device, 1, level)
    points: DeviceArray = tessellate_device(
        "triangle", factors.edge, factors.inside, "fractional_odd", clockwise=True
    ).points
    return points
