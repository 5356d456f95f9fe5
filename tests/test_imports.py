"""Who may know whom: the imports of the package against its rooms, which are its folders."""

from __future__ import annotations

import ast
import builtins
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import terrain_lod

PACKAGE = Path(terrain_lod.__file__).parent

# from the ground floor up: a room, and the rooms below that it may import besides its own
ROOMS = {
    "interrupts": "",
    "lazily": "",
    "errors": "",
    "arguments": "errors",
    "paths": "errors",
    "tasks": "errors arguments",
    "numbered": "errors arguments",
    "device": "errors arguments",
    "ground": "errors arguments device",
    "camera": "errors arguments device ground",
    "tessellation": "errors arguments device",
    "mesh": "errors arguments device ground",
    "files": "errors arguments paths ground mesh",
    "sources": "errors arguments ground files",
    "pyramid": "errors arguments tasks sources",
    "terrain": "errors arguments numbered device ground camera tessellation mesh",
    "streaming": "errors arguments device ground camera mesh files pyramid terrain",
    "curved": "errors arguments numbered device camera tessellation mesh files",
    "reference": "device ground camera tessellation mesh terrain",
    "measure": "errors arguments device ground camera mesh reference",
    "drawing": """errors arguments paths device ground camera tessellation mesh terrain measure
                  streaming""",
    "accessor": "ground mesh measure",
    "xarray": "errors ground camera mesh files terrain",
    "tilesets": "errors arguments paths tasks device ground sources terrain",
    "checks": """errors numbered device ground camera tessellation mesh terrain curved reference
                 measure""",
    "viewer": """errors arguments paths numbered device ground camera mesh files pyramid terrain
                 streaming curved measure drawing""",
    "reports": """errors arguments paths numbered device ground camera mesh terrain measure drawing
                  checks""",
    "cli": """interrupts errors arguments paths numbered device ground camera tessellation mesh
              files sources pyramid terrain streaming curved measure drawing tilesets viewer
              reports""",
    "__main__": "cli",
}
# within a function, so that a value can offer what is written above it
LATE = {
    ("ground", "files"),
    ("ground", "drawing"),
    ("mesh", "drawing"),
    ("mesh", "files"),
    ("terrain", "drawing"),
}
# a value that offers its writer, which has to know it: but for these, imports run one way
WRITERS = {
    ("mesh.mesh", "files.meshes.export"),
    ("ground.heightmap", "files.rasters.labelled"),
    ("ground.heightmap", "files.rasters.loading"),
}
# only there, so that everything else runs without them
GUARDED = {
    "pyopencl": {"device"},
    "rasterio": {
        "files.rasters.readers_gdal",
        "files.rasters.reprojection",
        "files.rasters.ortho",
    },
    "xarray": {"xarray", "files.rasters.labelled"},
    "pyproj": {"ground.place", "tilesets.geoid"},
}
# nobody waits for these on import
HEAVY = (
    "numpy",
    "pyopencl",
    "mapbox_earcut",
    "PIL",
    "pyvista",
    "vtkmodules",
    "matplotlib",
    "rasterio",
    "skimage",
    "scipy",
    "rich",
    "zarr",
    "xarray",
)
# nor for these before their first mesh, which no picture, page or file is made of
LATER_ROOMS = ("files", "pyramid", "streaming", "curved", "drawing", "viewer", "reports")


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


MODULES = {
    module_of(path): path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py"
}


def room_of(module: str) -> str:
    return module.split(".")[0]


def imports(path: Path) -> Iterator[tuple[str, bool]]:
    """Yield each imported module, and whether it is imported late; a dot before the package's own.

    Imports for annotations alone, under ``if TYPE_CHECKING``, are late: who names a thing knows it.
    """
    folder = path.relative_to(PACKAGE).parts[:-1]

    def own(node: ast.ImportFrom) -> Iterator[str]:
        base = [*folder[: len(folder) - node.level + 1], *(node.module or "").split(".")]
        module = ".".join(filter(None, base))
        for alias in node.names:
            inner = f"{module}.{alias.name}".lstrip(".")
            yield "." + (inner if inner in MODULES else module)

    def walk(node: ast.AST, late: bool) -> Iterator[tuple[str, bool]]:
        if isinstance(node, ast.Import):
            yield from ((alias.name, late) for alias in node.names)
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or "", late
        elif isinstance(node, ast.ImportFrom):
            yield from ((name, late) for name in own(node))
        late = late or isinstance(node, ast.FunctionDef) or _for_annotations(node)
        for child in ast.iter_child_nodes(node):
            yield from walk(child, late)

    yield from walk(ast.parse(path.read_text(encoding="utf-8")), late=False)


def _for_annotations(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def circles(knows: dict[str, set[str]]) -> list[set[str]]:
    """Return the groups of modules that import each other, be it by way of others."""
    reached = {module: set(known) for module, known in knows.items()}
    for through in knows:  # Warshall's algorithm
        for module in knows:
            if through in reached[module]:
                reached[module] |= reached[through]
    found = [{b for b in reached[a] if a in reached[b]} for a in knows if a in reached[a]]
    return [group for index, group in enumerate(found) if group not in found[:index]]


def test_rooms_are_the_folders_and_stand_on_those_below() -> None:
    assert set(ROOMS) == {room_of(module) for module in MODULES}
    below: list[str] = []
    for room, known in ROOMS.items():
        assert set(known.split()) <= set(below), f"{room} knows a room above it"
        below.append(room)


@pytest.mark.parametrize("module", sorted(MODULES))
def test_every_module_keeps_to_its_room(module: str) -> None:
    room = room_of(module)
    for name, late in imports(MODULES[module]):
        if name.startswith("."):
            other = room_of(name[1:])
            if other == room or (late and (room, other) in LATE):
                continue
            assert other in ROOMS[room].split(), f"{module} imports {name[1:]}"
        else:
            top = name.split(".")[0]
            allowed = GUARDED.get(top, {room})
            assert {module, room} & allowed, f"{module} imports {top}"


def test_no_room_is_allowed_what_it_does_not_use() -> None:
    used: dict[str, set[str]] = {room: set() for room in ROOMS}
    for module, path in MODULES.items():
        used[room_of(module)] |= {room_of(name[1:]) for name, _ in imports(path) if name[0] == "."}
    for room, known in ROOMS.items():
        late = {other for one, other in LATE if one == room}
        assert set(known.split()) == used[room] - {room} - late, room


def test_no_modules_import_each_other_but_a_value_and_its_writer() -> None:
    knows = {
        module: {name[1:] for name, _ in imports(path) if name[0] == "."} & MODULES.keys()
        for module, path in MODULES.items()
    }
    for value, writer in WRITERS:
        assert any({value, writer} <= group for group in circles(knows)), (value, writer)
        knows[value].remove(writer)
    assert circles(knows) == []


def test_circles_are_found() -> None:
    knows = {"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": {"d"}, "e": {"a"}}
    assert circles(knows) == [{"b", "c"}, {"d"}]


def test_packages_hold_no_code() -> None:
    for path in PACKAGE.rglob("__init__.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        for node in body:
            # what the package says of itself, names from its modules, and the list of them
            assert isinstance(node, ast.Expr | ast.ImportFrom | ast.Assign), path


def test_the_package_imports_what_its_stub_names_and_only_when_asked() -> None:
    stub = (PACKAGE / "__init__.pyi").read_text(encoding="utf-8")
    assert terrain_lod.__all__ == sorted(_listed(stub))
    for name in terrain_lod.__all__:
        value = getattr(terrain_lod, name)
        assert value is getattr(terrain_lod, name)
        if not isinstance(value, ModuleType):
            assert value.__module__.startswith("terrain_lod."), name
    with pytest.raises(AttributeError, match="'terrain_lod' has no attribute 'Terain'"):
        terrain_lod.Terain  # type: ignore[attr-defined]  # noqa: B018


def _listed(stub: str) -> list[str]:
    """Return the names of a stub's ``__all__``."""
    (listed,) = (node for node in ast.parse(stub).body if isinstance(node, ast.Assign))
    names: list[str] = ast.literal_eval(listed.value)
    return names


@pytest.mark.parametrize("package", [terrain_lod, terrain_lod.curved], ids=lambda it: it.__name__)
def test_all_is_true_and_sorted(package: ModuleType) -> None:
    names = package.__all__
    assert names == sorted(set(names))
    public = {
        name
        for name, value in ((name, getattr(package, name)) for name in dir(package))
        # folders that Python imported on the way are rooms, not names; curved is both
        if not name.startswith("_") and (not isinstance(value, ModuleType) or name in names)
    }
    # what Python has a name for itself stays its own in `from terrain_lod import *`
    assert public - set(vars(builtins)) == set(names)


def test_a_star_leaves_the_names_of_python_alone() -> None:
    names: dict[str, object] = {}
    exec("from terrain_lod import *", names)
    assert names["Terrain"] is terrain_lod.Terrain
    assert "open" in dir(terrain_lod)
    assert "open" not in names


def test_a_public_name_stands_in_one_place() -> None:
    assert not set(terrain_lod.__all__) & set(terrain_lod.curved.__all__)


def _printed(program: str) -> str:
    """Return what a program prints in a process of its own."""
    child = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    return child.stdout.strip()


def test_importing_the_package_loads_nothing_heavy() -> None:
    loaded = _printed("import sys, terrain_lod; print(*sys.modules)").split()
    assert not {name for name in loaded if name.split(".")[0] in HEAVY}
    rooms = {name.split(".")[1] for name in loaded if name.startswith("terrain_lod.")}
    assert rooms == {"interrupts", "lazily"}


def test_a_first_mesh_waits_for_nothing_that_it_is_not_made_of() -> None:
    program = "import sys, terrain_lod; terrain_lod.Terrain; print(*sys.modules)"
    loaded = _printed(program).split()
    light = {"numpy", "pyopencl"}
    assert not {name for name in loaded if name.split(".")[0] in set(HEAVY) - light}
    rooms = {name.split(".")[1] for name in loaded if name.startswith("terrain_lod.")}
    assert not rooms & set(LATER_ROOMS)


def test_a_device_is_listed_by_nobody_who_does_not_ask() -> None:
    # a driver that is listed starts threads, and does not survive a fork
    program = """
import terrain_lod as tl, terrain_lod.device.drivers as drivers
for name in tl.__all__:
    getattr(tl, name)
print(drivers._listing_process)
"""
    assert _printed(program) == "None"
