"""Modes of the viewer
===================

What the viewer shows, drawn without a window: ground and a curved pot, a picture a mode. ::

    python examples/view_modes.py [folder]

With a display, ``tl.view(ground)`` and ``tl.view(patches)`` open the same scenes to fly through.
"""

import sys
from pathlib import Path

from PIL import Image

import terrain_lod as tl
from terrain_lod.viewer.view import look

SIZE = (800, 450)
folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")


def sheet(what, camera, choices, name):
    """Draw a picture for each choice of settings, two beside each other, and save them as one."""
    rows = -(-len(choices) // 2)
    sheet = Image.new("RGB", (2 * SIZE[0], rows * SIZE[1]))
    for number, settings in enumerate(choices):
        lines = look(what, camera, settings=settings, picture=folder / "one.png")
        print(settings, *lines[:2], sep=", ")
        with Image.open(folder / "one.png") as picture:
            sheet.paste(picture, (number % 2 * SIZE[0], number // 2 * SIZE[1]))
    (folder / "one.png").unlink()
    sheet.save(folder / name)


ground = tl.sample("canyon")
modes = ("shaded", "wireframe", "lod", "deviation", "error", "normals")
sheet(
    ground, tl.default_camera(ground, size=SIZE), [{"mode": mode} for mode in modes], "ground.png"
)

patches = tl.curved.load_bpt(Path(__file__).parent / "data" / "pot.bpt")
camera = tl.Camera((0.5, -5.4, 3.9), (0.0, 0.0, 1.3), fov=45.0, size=SIZE)
choices = [{"factor": 2.0}, {"factor": 9.0}, {"mode": "wireframe"}, {"mode": "normals"}]
sheet(patches, camera, choices, "pot.png")
