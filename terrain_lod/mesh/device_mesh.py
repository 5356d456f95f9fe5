"""A mesh that stays where it was made, for whoever goes on with it there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..device.device import Device, DeviceArray
from .mesh import Achieved


@dataclass(frozen=True, eq=False)
class DeviceMesh:
    """An indexed triangle mesh in a device's memory, as :class:`Mesh` is one in the host's.

    Attributes
    ----------
    vertices : DeviceArray, (V, 3) float32
        Relative to `origin`; x east, y north, z up.
    normals : DeviceArray, (V, 3) float32
        Unit length.
    triangles : DeviceArray, (T, 3) int32
        Corners, counter-clockwise seen from above.
    origin : (3,) float64
        World point that `vertices` are relative to.
    crs : str or None
    achieved : Achieved or None
        The measured error, where the level of detail promised one.

    Notes
    -----
    The arrays are the mesh's own: no later mesh and no update of the terrain writes to them. An
    array's memory is given back when nothing holds the array: the mesh, a variable, a view of NumPy
    or a tensor made of it.

    Without a copy it is taken by

    - OpenCL, on any device: ``mesh.vertices.buffer`` in ``mesh.device.context``. Keep the array as
      long as the buffer is used. What is launched on ``mesh.device.queue`` runs after what made
      the mesh; other queues wait with ``mesh.device.finish()``
    - NumPy, on a CPU: ``mesh.vertices.view()``, or ``np.asarray(mesh.vertices)``
    - PyTorch and all that know DLPack, on a CPU: ``torch.from_dlpack(mesh.vertices)``

    OpenCL and CUDA do not share memory: CuPy and PyTorch on a GPU take a copy by way of the host,
    ``mesh.vertices.host()``.
    """

    vertices: DeviceArray
    normals: DeviceArray
    triangles: DeviceArray
    origin: npt.NDArray[np.float64]
    crs: str | None
    achieved: Achieved | None

    @property
    def device(self) -> Device:
        return self.vertices.device

    def __repr__(self) -> str:
        return (
            f"DeviceMesh({self.vertices.shape[0]} vertices, {self.triangles.shape[0]} triangles "
            f"on {self.device.info.name})"
        )
