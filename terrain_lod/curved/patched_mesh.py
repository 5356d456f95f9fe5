"""A mesh as curved patches on the device."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..arguments import finite
from ..device.device import Device, DeviceArray
from ..device.layout import PATCH_ADJACENT, PATCH_DOMINANT
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.soundness import sound_mesh
from .adjacency import Adjacency
from .creases import split_at_creases
from .pn import DevicePatchMesh, nets_on_device


@dataclass(frozen=True, eq=False)
class PatchedMesh:
    """A mesh as curved patches on the device.

    Attributes
    ----------
    mesh : Mesh
        With unit normals, and split where it is to be sharp.
    adjacency : Adjacency
    patches : DevicePatchMesh
    nets : DeviceArray, (T, 16, 3) float32
        Their control nets.
    """

    mesh: Mesh
    adjacency: Adjacency
    patches: DevicePatchMesh
    nets: DeviceArray

    @classmethod
    def upload(
        cls, mesh: Mesh, device: Device, *, sharp: bool | float = True, plane: bool = False
    ) -> PatchedMesh:
        """Make patches of a mesh that can be curved.

        Parameters
        ----------
        mesh : Mesh
        device : Device
        sharp : bool or float, optional
            As for :func:`terrain_lod.pn_triangles`.
        plane : bool, optional
            Keep the triangles plane.
        """
        # True is a number, too
        if not isinstance(sharp, bool | np.bool_):
            mesh = split_at_creases(mesh, finite("sharp", sharp))
        mesh = replace(mesh, normals=unit_normals(mesh.normals))
        adjacency = Adjacency.of(mesh)
        if isinstance(sharp, bool | np.bool_) and not sharp:
            adjacency = adjacency.without_neighbours()
        patches = DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
        nets = nets_on_device(plane_patches(patches, adjacency) if plane else patches)
        return cls(mesh, adjacency, patches, nets)


def plane_patches(patches: DevicePatchMesh, adjacency: Adjacency) -> DevicePatchMesh:
    """Return patches without neighbours to bend their edges with: they stay plane."""
    straight = adjacency.patches.copy()
    straight[:, PATCH_ADJACENT:PATCH_DOMINANT] = -1
    return replace(patches, patches=patches.device.array(straight))


def require_curvable(mesh: Mesh) -> None:
    """Refuse meshes without triangles, or with numbers that are not finite."""
    if not len(sound_mesh(mesh).triangles):
        raise InputError("expected triangles to curve, got an empty mesh")
    finite_normals = np.isfinite(mesh.normals).all(axis=1)
    if not finite_normals.all():
        vertex = int(np.argmin(finite_normals))
        raise InputError(f"expected finite normals, got {mesh.normals[vertex]} at vertex {vertex}")


def unit_normals(normals: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return normals of unit length; zero stays zero, and equal normals stay equal."""
    wide = normals.astype(np.float64)
    lengths = np.linalg.norm(wide, axis=1, keepdims=True)
    unit: npt.NDArray[np.float32] = (wide / np.where(lengths > 0, lengths, 1.0)).astype(np.float32)
    return unit
