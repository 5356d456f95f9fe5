"""How the gallery runs an example, and finds the pictures that it wrote."""

from __future__ import annotations

import builtins
import shutil
from pathlib import Path

from sphinx_gallery.scrapers import figure_rst

ARGUMENTS = {"render_flyover.py": ["flight", "--frames", "4", "--size", "960", "480"]}

FIRST = ("first_mesh.py", "own_heights.py", "three_views.py", "render_flyover.py")


class ReadingOrder:
    """Sorts examples: the easy ones first, then by name."""

    def __init__(self, _folder: str) -> None:
        pass

    def __call__(self, name: str) -> tuple[int, str]:
        return (FIRST.index(name) if name in FIRST else len(FIRST)), name


def arguments_of(_gallery, script) -> list[str]:
    """Return the command line of an example."""
    return ARGUMENTS.get(Path(script["src_file"]).name, [])


def name_file(_gallery, script: str) -> None:
    """Let an example know its own file, as Python does when it runs one."""
    builtins.__file__ = script


class WrittenPictures:
    """Finds the PNG files that an example has written since it was last asked."""

    def __init__(self) -> None:
        self._known: dict[Path, int] = {}

    def __repr__(self) -> str:
        return "WrittenPictures()"  # the same in every build

    def __call__(self, _block, block_vars, gallery_conf) -> str:
        """Copy new pictures to where the gallery wants them; return the text that shows them."""
        found = []
        for path in sorted(Path(block_vars["src_file"]).parent.rglob("*.png")):
            written = path.stat().st_mtime_ns
            if self._known.get(path) != written:
                self._known[path] = written
                found.append(path)
        places = [next(block_vars["image_path_iterator"]) for _ in found]
        for path, place in zip(found, places, strict=True):
            shutil.copy(path, place)
        return figure_rst(places, gallery_conf["src_dir"])
