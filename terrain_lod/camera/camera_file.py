"""Cameras in JSON files: one of them, or a list."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, Final

from ..errors import FileError, InputError
from .camera import Camera

_FIELDS: Final = tuple(field.name for field in fields(Camera))


def load_camera(path: Path) -> Camera:
    """Return the camera that a JSON file holds, alone or under the key ``camera``.

    It is an object with eye and target, and perhaps up, fov, size, near, far and height; null
    stands for what is not given.

    Raises
    ------
    FileError
        If the file cannot be read.
    InputError
        If it holds no camera.
    """
    content = _content(path)
    if isinstance(content, dict) and "camera" in content:
        content = content["camera"]
    return _camera(content, str(path))


def load_cameras(path: Path) -> list[Camera]:
    """Return the cameras of a JSON file: a list, alone or under ``cameras``.

    Each is as for :func:`load_camera`. Such is ``frames.json`` of a folder of pictures.

    Raises
    ------
    FileError
        If the file cannot be read.
    InputError
        If it is no list of cameras.
    """
    content = _content(path)
    if isinstance(content, dict) and "cameras" in content:
        content = content["cameras"]
    if not isinstance(content, list) or not content:
        raise InputError(f"expected a list of cameras in {path}, got {_told(content)}")
    return [_camera(entry, f"camera {number} of {path}") for number, entry in enumerate(content)]


def camera_fields(camera: Camera) -> dict[str, Any]:
    """Return a camera as such a file holds it; what is infinite is not given."""
    fields = asdict(camera)
    return {name: None if value == math.inf else value for name, value in fields.items()}


def _content(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"expected JSON in {path}, got {error}") from None


def _camera(entry: object, where: str) -> Camera:
    given = {name: value for name, value in _items(entry) if value is not None}
    if not {"eye", "target"} <= given.keys() <= set(_FIELDS):
        raise InputError(f"expected a camera ({', '.join(_FIELDS)}) in {where}, got {_told(entry)}")
    try:
        return Camera(**given)
    except InputError as error:
        raise InputError(f"{error}, in {where}") from None


def _items(entry: object) -> list[tuple[str, Any]]:
    return list(entry.items()) if isinstance(entry, dict) else []


def _told(content: object) -> str:
    """Return what was found, in a few words."""
    names = ", ".join(name for name, value in _items(content) if value is not None)
    return names or ("an empty list" if content == [] else type(content).__name__)
