"""``terrain-lod surface``: parametric surfaces, as a mesh or a picture."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from ..arguments import one_of
from ..camera.viewpoint import camera_around
from ..errors import InputError
from ..paths import require_folder
from .options import CameraOptions, Output, Partitioning, numbers
from .output import say


def surface(
    shape: Annotated[str, Parameter(metavar="SHAPE")],
    /,
    *,
    output: Output,
    factor: float = 5.0,
    patches: Annotated[tuple[int, int], numbers("ACROSSxDOWN", 2)] = (8, 4),
    numbers: Annotated[str | None, Parameter(metavar="NAME=VALUE,...")] = None,
    partitioning: Partitioning = "fractional_odd",
    device: str | None = None,
    view: CameraOptions = CameraOptions(),  # noqa: B008
) -> None:
    """Write a parametric surface, or draw it.

    Parameters
    ----------
    shape
        sphere, torus, moebius, klein, helicoid, seashell or superquadric.
    output
        File to write: .glb, .obj, .ply, .stl or .vtp; or .png, a picture.
    factor
        Segments along each side of a patch.
    patches
        How many along u and along v.
    numbers
        What shapes it, such as radius=2,tube=0.3.
    partitioning
        How the tessellator divides an edge.
    device
        cpu, gpu, a number or part of a name, see doctor. Default: a GPU if there is one.
    """
    from ..curved.surfaces import surface as parametric
    from ..device.device import Device
    from ..drawing.picture import draw, save_png
    from ..files.meshes.export import FORMATS
    from ..measure.cracks import crack_report

    require_folder(output)
    ending = one_of("output format", output.suffix.lower(), (*FORMATS, ".png"))
    for option, value in vars(view).items():
        if value is not None and ending != ".png":
            raise InputError(f"expected a picture, .png, with --{option}, got {output.name}")
    made = parametric(
        shape,
        patches=(int(patches[0]), int(patches[1])),
        factor=factor,
        partitioning=partitioning,
        device=Device.open(device),
        **_named(numbers),
    )
    if ending == ".png":
        camera = view.instead_of(camera_around(made.vertices, made.origin))
        save_png(draw(made, camera, style="plain"), output)
    else:
        made.save(output)
    say(f"{output}: {len(made.triangles):,} triangles, {len(made.vertices):,} vertices")
    say(str(crack_report(made)))


def _named(text: str | None) -> dict[str, float]:
    """Return numbers by name, of ``radius=2,tube=0.3``."""
    named: dict[str, float] = {}
    for part in text.split(",") if text else ():
        name, _, value = part.partition("=")
        # the function's own arguments are options, not numbers of a shape
        if name in ("patches", "factor", "partitioning", "device"):
            raise InputError(f"expected --{name} for {name}, got --numbers {part}")
        try:
            named[name.strip()] = float(value)
        except ValueError:
            raise InputError(
                f"expected --numbers such as radius=2,tube=0.3, got {text!r}"
            ) from None
    return named
