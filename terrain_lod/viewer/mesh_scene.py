"""Meshes to look at, curved: PN-triangles, and Bézier patches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera, Point
from ..camera.viewpoint import camera_around
from ..curved.bezier import bezier
from ..curved.patched_mesh import PatchedMesh, require_curvable
from ..curved.pn import patch_factors_on_device
from ..curved.smooth import edge_factors, tessellate_nets
from ..device.device import Device
from ..errors import InputError
from ..files.meshes.bpt import as_nets
from ..mesh.mesh import Mesh
from .colours import Paint, by_normal, of_clay, paper
from .mesh_settings import BezierSettings, CurvedSettings
from .rig import triangle_seen
from .scene import Frame, Pick, Request, Scene, numbered

# rows are where x, y and z go: y up becomes z up
_TURN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class PatchPick(Pick):
    """What is known of a place on a mesh.

    Attributes
    ----------
    patch : int
    edge_factors, inside_factors : tuple of float
    normal : (float, float, float)
        Of the triangle there.
    """

    patch: int
    edge_factors: tuple[float, ...]
    inside_factors: tuple[float, ...]
    normal: tuple[float, ...]

    def lines(self) -> tuple[str, ...]:
        return (
            f"patch {self.patch}  at {', '.join(f'{value:,.4g}' for value in self.point)}",
            f"factors {numbered(self.edge_factors)}  inside {numbered(self.inside_factors)}",
            f"normal {numbered(self.normal, 3)}",
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshFrame(Frame):
    """A curved mesh to be drawn."""

    def painted(self) -> Paint:
        match self.request.settings.mode:
            case "wireframe":
                return paper(self.mesh)
            case "lod":
                return self.by_detail()
            case "normals":
                return by_normal(self.mesh)
        return of_clay(self.mesh, self.sun)

    def pick(self, camera: Camera, x: float, y: float) -> PatchPick | None:
        seen = triangle_seen(self.mesh, camera, x, y)
        if seen is None:
            return None
        triangle, point = seen
        patch = int(np.searchsorted(self.triangle_offsets, triangle, "right")) - 1
        a, b, c = self.mesh.vertices[self.mesh.triangles[triangle]].astype(np.float64)
        across = np.cross(b - a, c - a)
        return PatchPick(
            point=point,
            patch=patch,
            edge_factors=tuple(self.edge_factors[patch].tolist()),
            inside_factors=tuple(self.inside_factors[patch].tolist()),
            normal=tuple((across / np.linalg.norm(across)).tolist()),
        )


class _Placed(Scene):
    """What meshes have in common: a box that they stand in."""

    def __init__(self, low: npt.NDArray[np.float64], high: npt.NDArray[np.float64]) -> None:
        self.bounds = low, high
        x, y, z = ((low + high) / 2).tolist()
        self.centre: Point = (x, y, z)
        self.diagonal = float(np.linalg.norm(high - low)) or 1.0

    def camera(self) -> Camera:
        return camera_around(np.stack(self.bounds))


class CurvedScene(_Placed):
    """A mesh whose triangles are curved.

    Parameters
    ----------
    mesh : Mesh
    y_up : bool, optional
        Its y axis points up: it is turned.
    device : Device, optional

    Raises
    ------
    InputError
        If it cannot be curved; see :func:`terrain_lod.pn_triangles`.
    """

    read_by_vtk = True

    def __init__(self, mesh: Mesh, *, y_up: bool = False, device: Device | None = None) -> None:
        require_curvable(mesh)
        if y_up:
            turned = {name: getattr(mesh, name) @ _TURN for name in ("vertices", "normals")}
            mesh = replace(
                mesh,
                **{name: array.astype(np.float32) for name, array in turned.items()},
                origin=mesh.origin @ _TURN,
            )
        used = mesh.vertices[mesh.triangles.ravel()].astype(np.float64) + mesh.origin
        super().__init__(used.min(axis=0), used.max(axis=0))
        self.mesh, self.device = replace(mesh, textures=None), Device.of(device)
        self.settings = CurvedSettings(diagonal=self.diagonal)
        # 1.0 degrees are not True
        self._patched = lru_cache(maxsize=1, typed=True)(self._upload)

    def _upload(self, sharp: bool | float) -> PatchedMesh:
        return PatchedMesh.upload(self.mesh, self.device, sharp=sharp)

    def tessellated(self, request: Request) -> MeshFrame:
        settings, camera = request.settings, request.camera
        assert isinstance(settings, CurvedSettings)
        view = camera.view(self.mesh.origin)
        sharp = {"normals": True, "never": False}.get(settings.sharp, settings.crease)
        with self.device.timed() as timeline:
            base = self._patched(sharp)
            of_edges = edge_factors(
                base.patches, base.adjacency, None, settings.formula(), self.diagonal, view
            )
            factors = patch_factors_on_device(
                base.patches,
                base.nets,
                of_edges,
                view,
                cull=True,
                back_cosine=None if settings.back_faces else 0.0,
            )
            mesh = tessellate_nets(
                self.mesh,
                base.nets,
                factors,
                settings.partitioning,
                settings.normals == "linear",
                timeline,
            )
        # vertices are not shared between patches
        owners = np.searchsorted(mesh.point_offsets, mesh.triangles[:, 0], "right") - 1
        return MeshFrame(
            request=request,
            scene=self,
            mesh=mesh,
            edge_factors=factors.edge.host(),
            inside_factors=factors.inside.host(),
            triangle_offsets=np.searchsorted(owners, np.arange(base.patches.count + 1)),
        )


class BezierScene(_Placed):
    """Bicubic Bézier patches.

    Parameters
    ----------
    patches : (P, 4, 4, 3) array_like
    y_up : bool, optional
        Their y axis points up: they are turned.
    device : Device, optional

    Raises
    ------
    InputError
        If they are no such patches, or none.
    """

    def __init__(
        self, patches: npt.ArrayLike, *, y_up: bool = False, device: Device | None = None
    ) -> None:
        self.nets = as_nets(patches) @ (_TURN if y_up else np.eye(3))
        if not len(self.nets):
            raise InputError("expected patches to look at, got none")
        points = self.nets.reshape(-1, 3)
        super().__init__(points.min(axis=0), points.max(axis=0))
        self.device = Device.of(device)
        self.settings = BezierSettings(diagonal=self.diagonal)

    def tessellated(self, request: Request) -> MeshFrame:
        settings, count = request.settings, len(self.nets)
        factor = settings.value("factor") if settings.tessellated else 1.0
        mesh = bezier(
            self.nets, factor=factor, partitioning=settings.partitioning, device=self.device
        )
        return MeshFrame(
            request=request,
            scene=self,
            mesh=mesh,
            edge_factors=np.full((count, 4), factor, np.float32),
            inside_factors=np.full((count, 2), factor, np.float32),
            triangle_offsets=np.arange(count + 1) * (len(mesh.triangles) // count),
        )
