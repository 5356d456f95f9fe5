"""The same name has the same default wherever it stands, or a reason here why not."""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from types import ModuleType
from typing import Any

import terrain_lod
from terrain_lod.camera import path
from terrain_lod.cli import app, flyover, options, report, smooth, view
from terrain_lod.drawing.flyover import Look, render_path
from terrain_lod.viewer.view import look

# a name, its defaults, and why they differ
DIFFERENT: dict[str, tuple[set[object], str]] = {
    "closed": (
        {False, "", (False, False)},
        "whether a mesh or a curve is; along which parameters a surface, a net of points is",
    ),
    "curved": ({True, False}, "displacing moves all of a mesh, a dent leaves plane what it misses"),
    "cull": ({True, False}, "a file is looked at from anywhere, a picture from its camera"),
    "maximum": ({5, 15.0, 64.0}, "levels; segments of a tile; all that a partitioning has"),
    "near": ({0.0, 0.1}, "of formulas, a distance; of a camera, where the depth buffer begins"),
    "origin": ({(0.0, 0.0), (0.0, 0.0, 0.0)}, "of a raster, of the world"),
    "pixels": (
        {0.0, 0.5, 1.0, 8.0, 16.0},
        "of a budget; off a curve; off the ground; along a segment; of a plane's deviation",
    ),
    "sharp": ({True, False}, "split normals are sharp either way; the option asks for angles"),
}


def public(package: ModuleType) -> Iterator[Callable[..., Any]]:
    for name in package.__all__:
        value = getattr(package, name)
        if isinstance(value, ModuleType):
            yield from public(value)
        elif not (inspect.isclass(value) and issubclass(value, BaseException)):
            yield value
            if inspect.isclass(value):
                yield from filter(inspect.isfunction, vars(value).values())


def commands() -> Iterator[Callable[..., Any]]:
    yield from (app.demo, app.render, app.mesh, view.view, smooth.smooth, report.report)
    for module in (options, flyover, smooth):
        yield from filter(is_dataclass, vars(module).values())


def defaults() -> dict[str, set[object]]:
    """Return the different defaults of each name; None, which is found later, is none."""
    helpers = (Look, render_path, path.flyover, path.orbit, path.load_path, look)
    found: dict[str, set[object]] = defaultdict(set)
    for each in (*public(terrain_lod), *commands(), *helpers):
        try:
            parameters = inspect.signature(each).parameters.values()
        except ValueError:
            continue
        for parameter in parameters:
            default = parameter.default
            named = default not in (parameter.empty, None) and not is_dataclass(default)
            if named and isinstance(default, bool | int | float | str | tuple):
                found[parameter.name].add(default)
    return found


def test_a_name_has_one_default_or_a_reason() -> None:
    found = defaults()
    several = {name: values for name, values in found.items() if len(values) > 1}
    expected = {name: values for name, (values, _) in DIFFERENT.items() if len(values) > 1}
    assert several == expected


def test_defaults_that_users_rely_on() -> None:
    found = defaults()
    for name, value in (
        ("fov", 45.0),
        ("size", (1920, 1080)),
        ("partitioning", "fractional_odd"),
        ("plane", "least_squares"),
        ("sun", (315.0, 40.0)),
        ("frames", 60),
        ("views", 3),
        ("style", "shaded"),
    ):
        assert found[name] == {value}, name
