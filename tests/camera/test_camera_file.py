"""Cameras from files: what they hold, and one line where a field is not what it should be."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from terrain_lod.camera.camera import Camera
from terrain_lod.camera.camera_file import load_camera, load_cameras
from terrain_lod.errors import FileError, InputError

GOOD = {"eye": [1, 2, 3], "target": [0, 0, 0]}


def written(tmp_path: Path, content: Any) -> Path:
    path = tmp_path / "camera.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_fields_come_as_they_are_and_null_is_not_given(tmp_path: Path) -> None:
    whole = {**GOOD, "up": [0, 1, 0], "fov": 30, "size": [64, 48], "near": 2, "far": 50}
    bare = Camera((1, 2, 3), (0, 0, 0))
    expected = Camera((1, 2, 3), (0, 0, 0), (0, 1, 0), 30.0, (64, 48), 2.0, 50.0)
    assert load_camera(written(tmp_path, whole)) == expected
    assert load_camera(written(tmp_path, {"camera": whole, "verdict": []})) == expected
    assert load_cameras(written(tmp_path, [GOOD, whole])) == [
        Camera((1, 2, 3), (0, 0, 0)),
        expected,
    ]
    far = load_camera(written(tmp_path, {**GOOD, "far": None, "height": None, "fov": None}))
    assert far == bare
    assert math.isinf(far.far)


BAD = [
    ({"size": 5}, r"expected size as \(width, height\), got 5"),
    ({"size": [5]}, r"expected size as \(width, height\), got \[5\]"),
    ({"size": [5, "x"]}, "expected a number for size, got 'x'"),
    ({"size": [5, 2.5]}, "expected a whole number"),
    ({"size": [5, [5]]}, "expected a number for size"),
    ({"eye": None}, "expected a camera"),
    ({"eye": "here"}, r"expected eye as \(x, y, z\), got 'here'"),
    ({"eye": [1, 2, None]}, "expected a number for eye, got None"),
    ({"target": {"x": 1}}, r"expected target as \(x, y, z\)"),
    ({"up": 1}, r"expected up as \(x, y, z\), got 1"),
    ({"far": "x"}, "expected a number for far, got 'x'"),
    ({"far": [9]}, "expected a number for far"),
    ({"far": math.nan}, "expected a finite far"),
    ({"far": 10**400}, "expected a number for far"),
    ({"far": 0.01}, "expected far > near"),
    ({"near": "x"}, "expected a number for near, got 'x'"),
    ({"near": {}}, "expected a number for near"),
    ({"fov": "wide"}, "expected a number for fov, got 'wide'"),
    ({"fov": []}, "expected a number for fov"),
    ({"height": "x"}, "expected a number for height, got 'x'"),
    ({"zoom": 2}, "expected a camera"),
]


@pytest.mark.parametrize(("field", "message"), BAD, ids=lambda it: str(it)[:20])
def test_a_wrong_field_is_one_line_that_names_the_file(
    tmp_path: Path, field: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message + r"[^\n]* in [^\n]*camera\.json[^\n]*$"):
        load_camera(written(tmp_path, {**GOOD, **field}))
    with pytest.raises(InputError, match=message + r"[^\n]* in camera 1 of [^\n]*$"):
        load_cameras(written(tmp_path, [GOOD, {**GOOD, **field}]))


@pytest.mark.parametrize("content", ["{", "[" * 100_000, "7", "[]", "null", '"x"', '{"camera": 3}'])
def test_what_is_no_camera_is_refused(tmp_path: Path, content: str) -> None:
    for load in (load_camera, load_cameras):
        with pytest.raises(InputError, match=r"^expected [^\n]*$"):
            load(written(tmp_path, content))  # type: ignore[operator]
        with pytest.raises(FileError, match="cannot read"):
            load(tmp_path / "none.json")  # type: ignore[operator]


def test_numbers_are_kept_as_floats() -> None:
    camera = Camera((1, 0, 0), (0, 0, 0), fov=30, near=1, far=9, height=4)
    assert [type(getattr(camera, name)) for name in ("fov", "near", "far", "height")] == [float] * 4
