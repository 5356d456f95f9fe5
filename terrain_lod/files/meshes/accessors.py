"""Arrays of a glTF file: buffers, views and accessors, sparse and quantized ones too.

Khronos Group: *glTF 2.0 Specification*, 2021, section 3.6; *KHR_mesh_quantization*, 2020.
"""

from __future__ import annotations

import base64
import urllib.parse
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from . import meshopt

_TYPES: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS: Final = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_MESHOPT: Final = ("EXT_meshopt_compression", "KHR_meshopt_compression")
# an accessor without data is zeros: more of them than this is a claim, not a mesh
_MOST_ZEROS: Final = 1 << 24


def pick(document: dict[str, Any], kind: str, index: Any) -> dict[str, Any]:
    """Return item `index` of a list of the document: no number from the end, no other type."""
    items = document.get(kind, [])
    if type(index) is not int or not 0 <= index < len(items) or not isinstance(items[index], dict):
        raise ValueError(f"there is no {index} among its {len(items)} {kind}")
    item: dict[str, Any] = items[index]
    return item


def whole(item: dict[str, Any], name: str, default: int | None = None) -> int:
    """Return a number of an item that says how many, or where."""
    value = item.get(name, default)
    if type(value) is not int or value < 0:
        raise ValueError(f"expected a number as its {name}, got {value!r}"[:120])
    return value


class Arrays:
    """The arrays of a document.

    Parameters
    ----------
    document : dict
        The file's JSON.
    binary : bytes
        The chunk behind it, empty for a .gltf.
    folder : pathlib.Path
        Where buffers in files of their own are looked for.
    """

    def __init__(self, document: dict[str, Any], binary: bytes, folder: Path) -> None:
        self._document = document
        self._binary = binary
        self._folder = folder
        self._buffers: dict[int, bytes] = {}
        self._views: dict[int, bytes] = {}

    def view(self, index: Any) -> bytes:
        """Return the bytes of a buffer view, decompressed."""
        view = pick(self._document, "bufferViews", index)
        if index not in self._views:
            extensions = view.get("extensions", {})
            packed = next((extensions[name] for name in _MESHOPT if name in extensions), None)
            data = self._slice(packed or view)
            if packed is not None:
                data = meshopt.decode(
                    data,
                    whole(packed, "count"),
                    whole(packed, "byteStride"),
                    packed["mode"],
                    packed.get("filter", "NONE"),
                )
            self._views[index] = data
        return self._views[index]

    def accessor(self, index: Any) -> npt.NDArray[Any]:
        """Return an accessor's numbers, (count, width): float where it is normalized."""
        accessor = pick(self._document, "accessors", index)
        kind = np.dtype(_TYPES[accessor["componentType"]])
        width = _WIDTHS[accessor["type"]]
        count = whole(accessor, "count")
        sparse = accessor.get("sparse")
        if "bufferView" in accessor:
            view = pick(self._document, "bufferViews", accessor["bufferView"])
            stride = whole(view, "byteStride", 0) or kind.itemsize * width
            data = self.view(accessor["bufferView"])
            values = _strided(data, kind, width, count, whole(accessor, "byteOffset", 0), stride)
        elif sparse is None or count > _MOST_ZEROS:
            raise ValueError(f"its accessor {index} has no data")
        else:
            values = np.zeros((count, width), kind)
        if sparse is not None:
            values = self._replaced(values, sparse)
        return _scaled(values) if accessor.get("normalized") is True else values

    def _replaced(self, values: npt.NDArray[Any], sparse: dict[str, Any]) -> npt.NDArray[Any]:
        """Return values with those of a sparse accessor put in."""
        count, where, what = whole(sparse, "count"), sparse["indices"], sparse["values"]
        kind = np.dtype(_TYPES[where["componentType"]])
        places = _strided(
            self.view(where["bufferView"]), kind, 1, count, whole(where, "byteOffset", 0)
        ).ravel()
        if kind.kind != "u" or (count and places.max() >= len(values)):
            raise ValueError("a sparse accessor replaces what is not there")
        values = values.copy()
        values[places] = _strided(
            self.view(what["bufferView"]), values.dtype, values.shape[1], count,
            whole(what, "byteOffset", 0),
        )  # fmt: skip
        return values

    def _slice(self, view: dict[str, Any]) -> bytes:
        data = self._buffer(view.get("buffer"))
        offset, length = whole(view, "byteOffset", 0), whole(view, "byteLength")
        if offset + length > len(data):
            raise ValueError(f"a view of {length} bytes from {offset} on, of {len(data)}")
        return data[offset : offset + length]

    def _buffer(self, index: Any) -> bytes:
        buffer = pick(self._document, "buffers", index)
        if index not in self._buffers:
            self._buffers[index] = self._load(buffer)
        return self._buffers[index]

    def _load(self, buffer: dict[str, Any]) -> bytes:
        uri = buffer.get("uri")
        if uri is None:
            return self._binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2], validate=True)
        path = self._folder / urllib.parse.unquote(uri)
        if "://" in uri or not path.is_file():
            raise ValueError(f"there is no {uri[:80]!r} beside it")
        with path.open("rb") as file:
            return file.read(whole(buffer, "byteLength"))


def _strided(
    data: bytes, kind: np.dtype[Any], width: int, count: int, offset: int, stride: int = 0
) -> npt.NDArray[Any]:
    """Return `count` rows of `width` numbers, `stride` bytes from row to row."""
    row = kind.itemsize * width
    stride = stride or row
    if count and offset + stride * (count - 1) + row > len(data):
        raise ValueError(f"{count} rows of {stride} bytes from {offset} on, of {len(data)} bytes")
    if not count:
        return np.empty((0, width), kind)
    return np.ndarray((count, width), kind, data, offset, (stride, kind.itemsize))


def _scaled(values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Return whole numbers as shares of their type's largest, -1 to 1 or 0 to 1."""
    if values.dtype.kind == "f":
        return values.astype(np.float64)
    return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
