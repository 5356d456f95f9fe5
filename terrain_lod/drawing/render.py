"""``tl.render``: a picture of ground, of a terrain or of any mesh, in one call."""

from __future__ import annotations

from pathlib import Path

from ..arguments import file_path, flag, instance, one_of, positive
from ..camera.camera import Camera
from ..camera.viewpoint import camera_around, default_camera
from ..device.device import Device
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from ..mesh.stretched import stretched
from ..streaming.terrain import StreamingTerrain
from ..terrain.lod import Lod, PromiseLod, Weighted
from ..terrain.terrain import Terrain
from .drape import Drape
from .exaggeration import ExaggeratedTerrain
from .graphics import require_graphics
from .picture import STYLES, SUN, SUN_ON_MESHES, Picture, draw, require_png, save_png
from .portrait import Portrait


def render(
    what: Heightmap | Terrain | Mesh,
    path: str | Path | None = None,
    *,
    camera: Camera | None = None,
    lod: Lod | PromiseLod | Weighted | None = None,
    style: str | None = None,
    sun: tuple[float, float] | None = None,
    texture: str | Path | None = None,
    wireframe: bool = False,
    height_range: tuple[float, float] | None = None,
    colour_range: tuple[float, float] | None = None,
    exaggeration: float = 1.0,
    sky_light: bool = True,
    notes: bool = True,
    device: Device | None = None,
) -> Picture:
    """Draw a picture of ground or of a mesh. Needs no display.

    Parameters
    ----------
    what : Heightmap, Terrain or Mesh
        Ground; a terrain, which is ground in tiles of your own and saves time from the second
        picture on; or triangles as they are.
    path : str or Path, optional
        Where to write the picture as PNG.
    camera : Camera, optional
        Its size is the picture's. Default: a good view over the ground, or around the mesh.
    lod : Lod, PromiseLod or Weighted, optional
        Of ground and terrain, as for :meth:`Terrain.mesh`.
    style : str, optional
        ``"shaded"``: sunlit ground, tinted by height, with haze. ``"plain"``: sunlit, all of one
        colour, for what is no ground. ``"wireframe"``: its triangles, hidden ones left out.
        ``"lod"``: the level of detail, which is how many cells a side of a triangle spans, bright
        the fewest, and an outline around every patch. ``"size"``: how many cells a patch is wide;
        ``"factor"``: into how many parts it is cut, by its inside factors. Colours go over what is
        there. Default: shaded, or plain for a mesh that no terrain made.
    sun : (float, float), optional
        Where the light comes from: degrees clockwise from north, degrees above the horizon.
        Default: 315, 40, as maps are lit; 200, 40, over the shoulder, for a mesh that no terrain
        made.
    texture : str or Path, optional
        Picture laid over ground or terrain in place of tints, row 0 north. For style "shaded".
    wireframe : bool, optional
        Draw the triangles over any style.
    height_range : (float, float), optional
        World heights of the lowest and the highest tint. Default: those of the ground, or of the
        mesh. Give the ground's to compare pictures of several meshes.
    colour_range : (float, float), optional
        Numbers of the first and the last colour, in styles "lod", "size" and "factor"; those beyond
        have them, too. Default: those that are there. Give the same to compare several meshes.
    exaggeration : float, optional
        How many times as high heights are drawn. Pixels that a level of detail keeps are those of
        the picture, metres are true; so are the camera's coordinates.
    sky_light : bool, optional
        Let ground that sees less of the sky have less of its light, so that valleys are deep. Not
        of pyramids and meshes.
    notes : bool, optional
        Say along the foot of the picture what it shows: a colour bar, a scale bar, north, where
        the camera looks and the sun stands, triangles and error.
    device : Device, optional
        For ground; a terrain has its own.

    Returns
    -------
    (H, W, 3) uint8
        Red, green, blue; row 0 at the top.

    Raises
    ------
    GraphicsError
        If this machine cannot draw; the message names the command that mends it.
    InputError
        If `what` is none of these, an option is not for it or unknown, a range falls, the picture
        is larger than drivers allow, or the name does not end in .png.
    FileError
        If the texture cannot be read or the picture cannot be written.
    DeviceMemoryError
        If the device cannot hold the ground or its mesh.

    Examples
    --------
    >>> picture = render(tl.sample("ridge"), "ridge.png", style="lod")      # doctest: +SKIP
    """
    instance("ground, a terrain or a mesh", what, Heightmap | Terrain | StreamingTerrain | Mesh)
    _refuse(what, lod=lod, texture=texture, device=device)
    if style is not None:
        one_of("style", style, STYLES)
    if camera is not None:
        instance("a Camera for camera", camera, Camera)
    if path is not None:
        require_png(path)
    require_graphics()
    tall = positive("exaggeration", exaggeration)
    noting, with_sky = flag("notes", notes), flag("sky_light", sky_light)
    if isinstance(what, Heightmap):
        what = Terrain(what, device=device)
    drape, ground, sky = None, None, None
    if isinstance(what, StreamingTerrain):
        if tall != 1:
            raise InputError(
                f"expected ground in memory with exaggeration {tall:g}, got a pyramid: "
                "draw its mesh"
            )
        ground = what.overview
        height_range = height_range or what.height_range
        camera = camera or default_camera(ground)
        what = what.mesh(camera, lod=lod)
    elif isinstance(what, Terrain):
        ground = what.ground
        drape = None if texture is None else Drape.load(file_path("texture", texture), ground)
        camera = camera or default_camera(ground, exaggeration=tall)
        drawn = ExaggeratedTerrain(what, tall)
        what, sky = drawn.mesh(camera, lod=lod), drawn.sky_light() if with_sky else None
    elif camera is None:
        seen = stretched(what, tall)
        camera = camera_around(seen.vertices, seen.origin).lifted(1 / tall)
    is_ground = what.patches is not None
    style = style or ("shaded" if is_ground else "plain")
    sun = (SUN if is_ground else SUN_ON_MESHES) if sun is None else sun
    if ground is None:
        picture = draw(
            what,
            camera,
            style=style,
            sun=sun,
            height_range=height_range,
            colour_range=colour_range,
            wireframe=wireframe,
            exaggeration=tall,
        )
    else:
        portrait = Portrait(
            ground,
            style,
            sun,
            tall,
            height_range,
            colour_range,
            drape,
            flag("wireframe", wireframe),
            sky,
        )
        picture = portrait.of(what, camera, notes=noting)
    if path is not None:
        save_png(picture, path)
    return picture


def _refuse(what: Heightmap | Terrain | StreamingTerrain | Mesh, **options: object) -> None:
    """Say which of the options that are given is not for `what`."""
    if isinstance(what, Heightmap):
        return
    foreign: tuple[str, ...] = ("lod", "texture", "device")
    if isinstance(what, Terrain):
        foreign = ("device",)
    elif isinstance(what, StreamingTerrain):
        foreign = ("texture", "device")
    for name in foreign:
        if options[name] is not None:
            raise InputError(f"expected ground with {name}=, got {what!r}")
