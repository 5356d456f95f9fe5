"""``terrain-lod smooth``: any triangle mesh, curved."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import numpy as np
from cyclopts import Parameter

from ..arguments import one_of
from ..camera.camera import Camera
from ..camera.viewpoint import camera_around
from ..errors import InputError
from ..paths import require_folder
from .lod_options import EdgeOptions
from .options import AnyPartitioning, CameraOptions, Output
from .output import say

if TYPE_CHECKING:
    from ..mesh.mesh import Mesh

_CREASE: Final = 30.0  # degrees


def smooth(
    mesh: Annotated[Path, Parameter(metavar="MESH")],
    /,
    *,
    output: Output,
    sharp: bool = False,
    crease: float | None = None,
    normals: Literal["quadratic", "linear"] = "quadratic",
    partitioning: AnyPartitioning = "fractional_odd",
    device: str | None = None,
    view: CameraOptions = CameraOptions(),  # noqa: B008
    detail: EdgeOptions = EdgeOptions(),  # noqa: B008
) -> None:
    """Curve the triangles of any mesh, and keep it closed.

    Parameters
    ----------
    mesh
        A mesh file: .glb, .gltf, .obj, .ply, .stl, .vtk, .vtp, .vtu or another that pyvista reads;
        with the extra meshes also .msh, .inp, .mesh, .off and what else meshio reads.
    output
        File to write: .glb, .obj, .ply, .stl or .vtp.
    sharp
        Keep edges sharp at which faces meet at more than the crease angle. Edges at which the
        file's own normals differ are sharp anyway.
    crease
        Degrees, 0 to 180. With --sharp. Default: 30.
    normals
        quadratic: of the curved surface. linear: as shading would blend them.
    partitioning
        How an edge is divided: by the tessellator, or semi_uniform, in halves of halves.
    device
        cpu, gpu, a number or part of a name, see doctor. Default: a GPU if there is one.
    """
    from ..curved.patch_factors import DistanceFactor
    from ..curved.smooth import pn_triangles
    from ..device.device import Device
    from ..files.meshes.export import FORMATS
    from ..measure.cracks import crack_report

    require_folder(output)
    one_of("mesh format", output.suffix.lower(), FORMATS)
    if crease is not None and not sharp:
        raise InputError(f"expected --sharp with --crease, got --crease {crease:g} alone")
    formula = detail.make()
    for option, value in vars(view).items():
        if value is not None and not formula.needs_camera:
            raise InputError(
                f"expected a --lod that looks through --{option}, got {detail.lod or 'uniform'}"
            )
    source = _load(mesh)
    camera = view.instead_of(camera_around(source.vertices, source.origin))
    if isinstance(formula, DistanceFactor) and not detail.given.keys() & {"near", "far"}:
        formula = replace(formula, near=_nearest(camera, source))
    made = pn_triangles(
        source,
        lod=formula,
        camera=camera if formula.needs_camera else None,
        normals=normals,
        sharp=(_CREASE if crease is None else crease) if sharp else True,
        partitioning=partitioning,
        cull=False,
        device=Device.open(device),
    )
    made.save(output)
    say(
        f"{output}: {len(made.triangles):,} triangles from {len(source.triangles):,}, "
        f"{len(made.vertices):,} vertices"
    )
    say(f"before: {crack_report(source)}")
    say(f"after: {crack_report(made)}")


def _load(path: Path) -> Mesh:
    """Read a mesh, and say what had to be done to it, unless -q."""
    from ..files.meshes import loading as mesh_loading

    quiet = not logging.getLogger("terrain_lod").isEnabledFor(logging.WARNING)
    notes = logging.getLogger(mesh_loading.__name__)
    notes.setLevel(logging.NOTSET if quiet else logging.INFO)
    return mesh_loading.load_mesh(path)


def _nearest(camera: Camera, mesh: Mesh) -> float:
    """Return how far the sphere around the mesh's bounds is from the eye."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle = (low.astype(np.float64) + high) / 2 + mesh.origin
    return max(
        0.0, float(np.linalg.norm(middle - camera.eye)) - float(np.linalg.norm(high - low)) / 2
    )
