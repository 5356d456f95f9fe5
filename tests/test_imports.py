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
        "errors arguments layout factors grid heightmap relief camera lod pattern mesh queries "
        "files files.degrees opencl opencl.device_info opencl.parameters opencl.timeline drawing "
        "drawing.viewpoint drawing.colours measure measure.soundness measure.open_edges "
        "viewer.camera_path drawing.drape curved curved.patch_factors curved.curved_mesh "
        "curved.adjacency curved.shape_numbers",
        "",
    ),
    # ground, patches and meshes from files and to files; what can be known of a mesh alone
    "files": ("files.loading files.readers* files.samples files.bpt files.ladders", "values"),
    "meshes": (
        "files.export files.glb files.ply files.mesh_* measure.opposed_edges measure.cracks "
        "curved.creases",
        "values",
    ),
    # the stages again in float64, for tests and the doctor
    "reference": ("reference*", "values"),
    # OpenCL behind four names, what travels on it, and sums that any stage needs
    "device": (
        "device opencl.sources opencl.linker opencl.elf_linker buffers scan pattern_room "
        "curved.queues",
        "values",
    ),
    # arrows of the diagram in terrain.py, and their like for surfaces; they do not know each other
    "stages": (
        "analysis ladder hull selection tessellator domain holes queries_ground weights "
        "curved.semi_uniform curved.pn",
        "values device",
    ),
    # put stages one after the other
    "chains": (
        "terrain promise curved.patched_mesh curved.smooth curved.amplify curved.displaced* "
        "curved.decals curved.bezier curved.surfaces curved.curves curved.uniform_quads",
        "values files meshes device stages",
    ),
    # take a mesh to a number or a picture
    "sinks": (
        "measure.error measure.screen_error queries_mesh accessor notebook drawing.graphics "
        "drawing.render drawing.pattern_*",
        "values meshes device reference",
    ),
    # many meshes to a page, or to a window
    "reports": (
        "report* viewer viewer.* cli.demonstration",
        "values files meshes reference device stages chains sinks",
    ),
    # know everything; nothing imports them
    "commands": (
        "cli* doctor* __main__",
        "values files meshes reference device stages chains sinks reports",
    ),
}
# modules of one room that do not know each other
STRANGERS = {"stages"}
# within a function, so that a value object can offer what is written above it
LATE = {
    ("mesh", "files.export"),
    ("heightmap", "notebook"),
    ("mesh", "notebook"),
    ("terrain", "notebook"),
    ("files.export", "measure.error"),
}
# only there, so that everything else runs without them
GUARDED = {"pyopencl": {"device"}, "rasterio": {"files.readers_geo"}}
# nobody waits for these on import
HEAVY = ("pyvista", "vtkmodules", "matplotlib", "rasterio", "skimage", "scipy", "rich")


def room_of(module: str) -> str:
    for room, (modules, _) in ROOMS.items():
        if any(fnmatchcase(module, pattern) for pattern in modules.split()):
            return room
    raise AssertionError(f"{module} stands in no room: add it to ROOMS, and to ARCHITECTURE.md")


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


MODULES = {module_of(path): path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE}
MODULES |= {path.stem: path for path in PACKAGE.glob("*.py") if path.stem != "__init__"}


def imports(path: Path) -> Iterator[tuple[str, bool]]:
    """Yield each imported module, and whether it is imported late; a dot before the package's own.

    Imports for annotations alone, under ``if TYPE_CHECKING``, are left out.
    """
    folder = path.relative_to(PACKAGE).parts[:-1]

    def own(node: ast.ImportFrom) -> Iterator[str]:
        base = [*folder[: len(folder) - node.level + 1], *(node.module or "").split(".")]
        module = ".".join(filter(None, base))
        for alias in node.names:
            inner = f"{module}.{alias.name}".lstrip(".")
            yield "." + (inner if inner in MODULES else module)

    def walk(node: ast.AST, late: bool) -> Iterator[tuple[str, bool]]:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            return
        if isinstance(node, ast.Import):
            yield from ((alias.name, late) for alias in node.names)
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or "", late
        elif isinstance(node, ast.ImportFrom):
            yield from ((name, late) for name in own(node))
        late = late or isinstance(node, ast.FunctionDef)
        for child in ast.iter_child_nodes(node):
            yield from walk(child, late)

    yield from walk(ast.parse(path.read_text(encoding="utf-8")), late=False)


@pytest.mark.parametrize("module", sorted(MODULES))
def test_every_module_keeps_to_its_room(module: str) -> None:
    room = room_of(module)
    allowed = {room, *ROOMS[room][1].split()}
    for name, late in imports(MODULES[module]):
        if name.startswith("."):
            other = name[1:]
            if other in ("", module) or (late and (module, other) in LATE):
                continue
            assert room_of(other) in allowed, f"{module}, of the {room}, imports {other}"
            assert room not in STRANGERS or room_of(other) != room, f"{module} knows {other}"
        else:
            top = name.split(".")[0]
            assert module in GUARDED.get(top, {module}), f"{module} imports {top}"


def test_rooms_list_no_module_that_is_gone() -> None:
    for modules, _ in ROOMS.values():
        for pattern in modules.split():
            assert any(fnmatchcase(module, pattern) for module in MODULES), pattern


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
        "import sys, terrain_lod, terrain_lod.device.device as device\n"
        f"print([name for name in {HEAVY} if name in sys.modules], device._listing_process)"
    )
    child = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert child.stdout.strip() == "[] None", child.stdout + child.stderr
