"""The pages of the reference, made from ``terrain_lod.__all__``: no name can be forgotten.

A page is a room, the folder that a name comes from. A room without a title here stops the build.
"""

from __future__ import annotations

import builtins
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import terrain_lod

# rooms in a reader's order: title, and what is found there
TITLES = {
    "ground": ("Ground", "A raster of heights, whatever it came from."),
    "camera": ("Cameras", "Where a picture is taken from."),
    "terrain": ("Terrain and its levels of detail", "From ground to triangles."),
    "pyramid": ("Pyramids", "Ground of any size, on disk."),
    "streaming": ("Terrain over pyramids", "What a view needs is held, and no more."),
    "mesh": ("Meshes", "What comes out, and what it can be asked."),
    "files": ("Files", "Ground and meshes, in and out."),
    "measure": ("Measuring", "How far a mesh is from the ground, and whether it has cracks."),
    "drawing": ("Pictures", "Meshes drawn without a display."),
    "viewer": ("Viewer", "Windows and pages that move."),
    "reports": ("Reports", "Levels of detail, compared on paper."),
    "tilesets": ("Tiles for the web", "Pyramids of ground, each tile with its measured error."),
    "tessellation": ("Tessellation", "From factors to patterns of points and triangles."),
    "curved": ("Curved meshes", "Any mesh, curved, displaced, or made of patches and formulas."),
    "numbered": ("Numbers of formulas", "What a number may be, and how people are asked for it."),
    "device": ("Devices", "Where kernels run."),
    "errors": ("Errors", "Everything that is raised on purpose."),
}


def names_of(module: ModuleType) -> Iterator[tuple[str, object]]:
    """Yield each public name with the module it is imported from, and what it is."""
    # those that Python has, too, are in no __all__, so that a star leaves its own alone
    shared = [name for name in vars(builtins) if name in dir(module) and name[0] != "_"]
    for name in [*module.__all__, *shared]:
        value = getattr(module, name)
        if isinstance(value, ModuleType):
            yield from names_of(value)
        else:
            yield f"{module.__name__}.{name}", value


def public_names() -> dict[str, str]:
    """Return the names as users import them, and by themselves."""
    return {full: full.rpartition(".")[2] for full, _ in names_of(terrain_lod)}


def public_bases(_app, _name, _value, _options, bases) -> None:
    """Name the bases of a class as users import them."""
    public = {value: full for full, value in names_of(terrain_lod)}
    bases[:] = [
        f":py:class:`~{public[base]}`" if base in public else f"``{base.__name__}``"
        for base in bases
    ]


def every_name_has_a_page(_app, env) -> None:
    """Stop the build where a public name is documented nowhere."""
    missing = sorted(set(public_names()) - set(env.domains.python_domain.objects))
    if missing:
        raise SystemExit(f"no page of the reference has {', '.join(missing)}")


def write_reference(folder: Path) -> None:
    """Write a page for each room that offers a name, and the page that lists them all."""
    rooms: dict[str, dict[str, object]] = {room: {} for room in TITLES}
    for full, value in names_of(terrain_lod):
        rooms[_room_of(value)][full] = value
    folder.mkdir(exist_ok=True)
    for room, names in rooms.items():
        if names:
            _write(folder / f"{room}.rst", _page(*TITLES[room], names))
    _write(folder / "index.rst", _index({room: names for room, names in rooms.items() if names}))


def _room_of(value: object) -> str:
    module = value.__module__ if hasattr(value, "__module__") else "nowhere"
    return module.split(".")[1]


def _heading(title: str) -> list[str]:
    return [title, "=" * len(title), ""]


def _page(title: str, what: str, names: dict[str, object]) -> list[str]:
    lines = [*_heading(title), what, "", *_summary(names)]
    for full, value in names.items():
        short = full.removeprefix("terrain_lod.")
        lines += [short, "-" * len(short), "", f".. auto{_kind(value)}:: {full}"]
        if inspect.isclass(value):
            lines.append("   :members:")
            if any(base is not object for base in value.__bases__):
                lines.append("   :show-inheritance:")
        lines += ["", ""]
    return lines


def _kind(value: object) -> str:
    if inspect.isclass(value):
        return "exception" if issubclass(value, BaseException) else "class"
    return "function" if callable(value) else "data"


def _summary(names: dict[str, object]) -> list[str]:
    return [
        ".. currentmodule:: terrain_lod",
        "",
        ".. autosummary::",
        "   :nosignatures:",
        "",
        *[f"   {full.removeprefix('terrain_lod.')}" for full in names],
        "",
    ]


def _index(rooms: dict[str, dict[str, object]]) -> list[str]:
    lines = [
        *_heading("Reference"),
        "Every public name, as ``import terrain_lod as tl`` offers it, with shapes and units.",
        "",
        ".. toctree::",
        "   :hidden:",
        "",
        *[f"   {room}" for room in rooms],
        "",
    ]
    for room, names in rooms.items():
        title, what = TITLES[room]
        lines += [
            title,
            "-" * len(title),
            "",
            f"{what} :doc:`More <{room}>`.",
            "",
            *_summary(names),
        ]
    return lines


def _write(path: Path, lines: list[str]) -> None:
    text = "\n".join(lines)
    # an unchanged page is not read again
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
