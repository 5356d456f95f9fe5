"""Who may know whom: the imports of the package against the rooms it is built of."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

import terrain_lod

PACKAGE = Path(terrain_lod.__file__).parent

# room: its modules, and the rooms whose modules they may import besides their own
ROOMS = {
    # numbers, checks and frozen objects: they know nothing above them
    "values": (
        "errors arguments layout factors patch_factors grid heightmap camera* viewpoint lod "
        "pattern mesh curved_mesh drape soundness open_edges adjacency shape_numbers colours "
        "degrees files device_info parameters timeline queries",
        "",
    ),
    # ground, patches and meshes from files and to files; what can be known of a mesh alone
    "files": ("loading readers* samples bpt", "values"),
    "meshes": ("export glb ply mesh_loading opposed_edges cracks creases", "values"),
    # the stages again in float64, for tests and the doctor
    "reference": ("reference", "values"),
    # OpenCL behind four names, what travels on it, and sums that any stage needs
    "device": ("device sources linker elf_linker buffers scan queues pattern_room", "values"),
    # arrows of the diagram in terrain.py, and their like for surfaces; they do not know each other
    "stages": (
        "analysis ladder hull selection tessellator semi_uniform domain holes queries_ground "
        "weights pn",
        "values device",
    ),
    # put stages one after the other
    "chains": (
        "terrain promise smooth amplify displaced* decals bezier surfaces curves uniform_quads",
        "values files meshes device stages",
    ),
    # take a mesh to a number or a picture
    "sinks": (
        "error screen_error queries_mesh accessor graphics render notebook pattern_*",
        "values meshes device reference",
    ),
    # many meshes to a page, or to a window
    "reports": (
        "report* compare* stability* demo flyover viewer*",
        "values files meshes reference device stages chains sinks",
    ),
    # know everything; nothing imports them
    "commands": (
        "cli* doctor checkup checks* __main__",
        "values files meshes reference device stages chains sinks reports",
    ),
}
# modules of one room that do not know each other
STRANGERS = {"stages"}
# within a function, so that a value object can offer what is written above it
LATE = {
    ("mesh", "export"),
    ("heightmap", "notebook"),
    ("mesh", "notebook"),
    ("terrain", "notebook"),
    ("export", "error"),
}
# only there, so that everything else runs without them
GUARDED = {"pyopencl": {"device"}, "rasterio": {"readers_geo"}}
# nobody waits for these on import
HEAVY = ("pyvista", "vtkmodules", "matplotlib", "rasterio", "skimage", "scipy", "rich")


def room_of(module: str) -> str:
    for room, (modules, _) in ROOMS.items():
        if any(fnmatchcase(module, pattern) for pattern in modules.split()):
            return room
    raise AssertionError(f"{module}.py stands in no room: add it to ROOMS, and to ARCHITECTURE.md")


def module_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> Iterator[tuple[str, bool]]:
    """Yield each imported module of the package or of others, and whether it is imported late.

    Imports for annotations alone, under ``if TYPE_CHECKING``, are left out.
    """
    depth = len(path.relative_to(PACKAGE).parts)

    def walk(node: ast.AST, late: bool) -> Iterator[tuple[str, bool]]:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            return
        if isinstance(node, ast.Import):
            yield from ((alias.name, late) for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            if node.level == 0:
                yield node.module or "", late
            elif node.level == depth and node.module:
                yield f".{node.module}", late
            elif node.level == depth:
                yield from ((f".{alias.name}", late) for alias in node.names)
        late = late or isinstance(node, ast.FunctionDef)
        for child in ast.iter_child_nodes(node):
            yield from walk(child, late)

    yield from walk(ast.parse(path.read_text(encoding="utf-8")), late=False)


FILES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_every_module_keeps_to_its_room(path: Path) -> None:
    module = module_of(path)
    room = room_of(module)
    allowed = {room, *ROOMS[room][1].split()}
    for name, late in imports(path):
        if name.startswith("."):
            other = name[1:].split(".")[0]
            if other == module or (late and (module, other) in LATE):
                continue
            assert room_of(other) in allowed, f"{module}.py, of the {room}, imports {other}.py"
            assert room not in STRANGERS or room_of(other) != room, f"{module} knows {other}"
        else:
            top = name.split(".")[0]
            assert module in GUARDED.get(top, {module}), f"{module}.py imports {top}"


def test_rooms_list_no_module_that_is_gone() -> None:
    known = {module_of(path) for path in FILES}
    for modules, _ in ROOMS.values():
        for pattern in modules.split():
            assert any(fnmatchcase(module, pattern) for module in known), pattern


def test_all_is_true_and_sorted() -> None:
    names = terrain_lod.__all__
    assert names == sorted(set(names))
    for name in names:
        assert hasattr(terrain_lod, name)
    public = {
        name
        for name, value in vars(terrain_lod).items()
        if not name.startswith("_") and not isinstance(value, type(ast))
    }
    assert public == set(names)


def test_importing_the_package_loads_nothing_heavy_and_lists_no_devices() -> None:
    # a driver that is listed starts threads, and does not survive a fork
    program = (
        "import sys, terrain_lod, terrain_lod.device as device\n"
        f"print([name for name in {HEAVY} if name in sys.modules], device._listing_process)"
    )
    child = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert child.stdout.strip() == "[] None", child.stdout + child.stderr
