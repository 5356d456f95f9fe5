"""EXT_meshopt_compression, decoded: what gltfpack writes.

Khronos Group: *EXT_meshopt_compression*, 2021, appendix A (bitstreams) and B (filters).
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

Bytes = npt.NDArray[np.uint8]

_BLOCK_BYTES: Final = 8192
_BLOCK_ELEMENTS: Final = 256
_GROUP: Final = 16  # elements that share the number of bits of their differences
_TAIL: Final = 32  # bytes at the end, at least, of attributes
_INDEX_TAIL: Final = 16


def decode(data: bytes, count: int, stride: int, mode: str, filter_name: str) -> bytes:
    """Return a buffer view's bytes, `count` elements of `stride` bytes.

    Raises
    ------
    ValueError
        If the data is damaged, or the mode or filter is unknown.
    """
    if count < 0 or not 0 < stride <= 256 or count > 256 * (len(data) + 1):
        raise ValueError(f"{len(data)} compressed bytes cannot be {count} elements of {stride}")
    source = np.frombuffer(data, np.uint8)
    if mode == "ATTRIBUTES":
        return _filtered(_attributes(source, count, stride), filter_name).tobytes()
    if mode == "TRIANGLES":
        indices = _triangles(data, count)
    elif mode == "INDICES":
        indices = _sequence(data, count)
    else:
        raise ValueError(f"unknown mode {mode!r} of EXT_meshopt_compression")
    if stride not in (2, 4):
        raise ValueError(f"expected indices of 2 or 4 bytes, got {stride}")
    return np.array(indices, np.uint32).astype(f"<u{stride}").tobytes()


# attributes: differences to the element before, byte by byte of the element, in groups of 16


def _attributes(source: Bytes, count: int, stride: int) -> Bytes:
    if stride % 4 or not len(source) or source[0] != 0xA0:
        raise ValueError("compressed attributes do not begin as they must")
    tail = max(stride, _TAIL)
    if len(source) < 1 + tail:
        raise ValueError("compressed attributes are too short")
    last = source[-stride:].copy()
    end, position = len(source) - tail, 1
    result = np.empty((count, stride), np.uint8)
    block = min(_BLOCK_BYTES // stride // _GROUP * _GROUP, _BLOCK_ELEMENTS)
    for first in range(0, count, block):
        size = min(block, count - first)
        for byte in range(stride):
            deltas, position = _deltas(source, position, end, size)
            # zigzag: 0, -1, 1, -2 ...
            signed = (deltas >> 1) ^ (0 - (deltas & 1))
            sums = np.cumsum(signed, dtype=np.uint8) + last[byte]
            result[first : first + size, byte] = sums
        last = result[first + size - 1]
    return result


def _deltas(source: Bytes, position: int, end: int, size: int) -> tuple[Bytes, int]:
    """Return `size` differences of one byte of the elements, and where they end."""
    groups = -(-size // _GROUP)
    headers = source[position : position + -(-groups // 4)]
    position += len(headers)
    widths = ((headers[:, None] >> np.array([0, 2, 4, 6], np.uint8)) & 3).ravel()
    if len(widths) < groups:
        raise ValueError("compressed attributes end early")
    deltas = np.zeros(groups * _GROUP, np.uint8)
    for group, width in enumerate(widths[:groups].tolist()):
        if width == 0:
            continue
        target = deltas[group * _GROUP : (group + 1) * _GROUP]
        packed = _GROUP * (2, 4, 8)[width - 1] // 8
        raw = source[position : position + packed]
        position += packed
        if position > end:
            raise ValueError("compressed attributes end early")
        if width == 3:
            target[:] = raw
            continue
        # from the highest bits on; a value of all ones stands in full behind the group
        if width == 1:
            target[:] = ((raw[:, None] >> np.array([6, 4, 2, 0], np.uint8)) & 3).ravel()
            escaped = target == 3
        else:
            target[:] = ((raw[:, None] >> np.array([4, 0], np.uint8)) & 15).ravel()
            escaped = target == 15
        more = int(np.count_nonzero(escaped))
        if position + more > end:
            raise ValueError("compressed attributes end early")
        target[escaped] = source[position : position + more]
        position += more
    return deltas[:size], position


def _filtered(elements: Bytes, name: str) -> npt.NDArray[Any]:
    """Return elements (N, stride) with a filter of the specification undone."""
    stride = elements.shape[1]
    if name == "NONE":
        return elements
    if name == "OCTAHEDRAL" and stride in (4, 8):
        return _octahedral(elements.view(f"<i{stride // 4}"))
    if name == "QUATERNION" and stride == 8:
        return _quaternions(elements.view("<i2"))
    if name == "EXPONENTIAL":
        words = elements.view("<i4")
        mantissas = (words << 8) >> 8
        numbers: npt.NDArray[Any] = np.ldexp(mantissas.astype(np.float32), words >> 24).astype(
            "<f4"
        )
        return numbers
    raise ValueError(f"unknown filter {name!r} of elements of {stride} bytes")


def _octahedral(codes: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return unit vectors from two coordinates on an octahedron; the third is what one is."""
    limit = np.iinfo(codes.dtype).max
    x, y, one, kept = codes.astype(np.float32).T
    z = one - abs(x) - abs(y)
    fold = np.minimum(z, 0)
    x = x + np.where(x >= 0, fold, -fold)
    y = y + np.where(y >= 0, fold, -fold)
    lengths = np.sqrt(x * x + y * y + z * z)
    vectors = np.stack([x, y, z], axis=1) * (limit / np.where(lengths > 0, lengths, 1))[:, None]
    vectors = np.trunc(vectors + np.where(vectors >= 0, 0.5, -0.5))
    return np.concatenate([vectors, kept[:, None]], axis=1).astype(codes.dtype)


def _quaternions(codes: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return quaternions from three components; the largest is left out, and is positive."""
    one = (codes[:, 3] | 3).astype(np.float32)
    three = codes[:, :3].astype(np.float32) / (one * np.float32(2**0.5))[:, None]
    largest = np.sqrt(np.maximum(0, 1 - (three * three).sum(axis=1)))
    result = np.empty(codes.shape, np.int16)
    place = codes[:, 3] & 3
    rows = np.arange(len(codes))
    scaled = np.rint(np.concatenate([three, largest[:, None]], axis=1) * 32767)
    for component in range(4):
        result[rows, (place + 1 + component) % 4] = scaled[:, component]
    return result


# indices


class _Source:
    """Bytes read one by one, and numbers of seven bits a byte."""

    def __init__(self, data: bytes, position: int, end: int) -> None:
        self._data = data
        self.position = position
        self._end = end

    def byte(self) -> int:
        if not 0 <= self.position < self._end:
            raise ValueError("compressed indices end early")
        self.position += 1
        return self._data[self.position - 1]

    def number(self) -> int:
        value = 0
        for shift in range(0, 35, 7):
            byte = self.byte()
            value |= (byte & 127) << shift
            if byte < 128:
                return value
        raise ValueError("compressed indices have a number without an end")

    def near(self, before: int) -> int:
        """Return an index written as a difference."""
        value = self.number()
        return (before + ((value >> 1) ^ -(value & 1))) & 0xFFFFFFFF


def _triangles(data: bytes, count: int) -> list[int]:
    """Return the corners of triangles, each told by an edge or a vertex that lately was."""
    if count % 3 or len(data) < 1 + count // 3 + _INDEX_TAIL or data[0] >> 4 != 0xE:
        raise ValueError("compressed triangles do not begin as they must")
    version = data[0] & 15
    if version > 1:
        raise ValueError(f"unknown version {version} of compressed triangles")
    triangle_count = count // 3
    table = data[-_INDEX_TAIL:]
    source = _Source(data, 1 + triangle_count, len(data) - _INDEX_TAIL)
    edges: list[tuple[int, int]] = [(0xFFFFFFFF, 0xFFFFFFFF)] * 16
    vertices = [0xFFFFFFFF] * 16
    edge_place = vertex_place = fresh = last = 0
    limit = 13 if version else 15
    result: list[int] = []

    def push_edge(a: int, b: int) -> None:
        nonlocal edge_place
        edges[edge_place] = a, b
        edge_place = (edge_place + 1) & 15

    def push_vertex(vertex: int) -> None:
        nonlocal vertex_place
        vertices[vertex_place] = vertex
        vertex_place = (vertex_place + 1) & 15

    for code in data[1 : 1 + triangle_count]:
        if code < 0xF0:
            a, b = edges[(edge_place - 1 - (code >> 4)) & 15]
            low = code & 15
            if low == 0:
                c, fresh = fresh, fresh + 1
                push_vertex(c)
            elif low < limit:
                c = vertices[(vertex_place - 1 - low) & 15]
            else:
                # one before the last explicit index, one after it, or a difference to it
                c = source.near(last) if low == 15 else last + (1 if low == 14 else -1)
                c &= 0xFFFFFFFF
                last = c
                push_vertex(c)
            push_edge(c, b)
            push_edge(a, c)
        else:
            low = code & 15
            explicit = low >= 14
            pair = source.byte() if explicit else table[low]
            if explicit and pair == 0:
                fresh = 0
            kinds = (0 if low < 15 else 15, pair >> 4, pair & 15)
            corners = []
            # all that is new is counted before what is explicit is read
            for kind in kinds:
                if kind == 0:
                    corners.append(fresh)
                    fresh += 1
                else:
                    corners.append(vertices[(vertex_place - kind) & 15])
            for index, kind in enumerate(kinds):
                if kind == 15:
                    corners[index] = last = source.near(last)
            a, b, c = corners
            for kind, corner in zip(kinds, corners, strict=True):
                if kind in (0, 15):
                    push_vertex(corner)
            push_edge(b, a)
            push_edge(c, b)
            push_edge(a, c)
        result += (a, b, c)
    return result


def _sequence(data: bytes, count: int) -> list[int]:
    """Return indices, each written as the difference to one of two before it."""
    if len(data) < 1 + count + 4 or data[0] >> 4 != 0xD or data[0] & 15 > 1:
        raise ValueError("compressed indices do not begin as they must")
    source = _Source(data, 1, len(data) - 4)
    last = [0, 0]
    result = []
    for _ in range(count):
        value = source.number()
        which, value = value & 1, value >> 1
        last[which] = (last[which] + ((value >> 1) ^ -(value & 1))) & 0xFFFFFFFF
        result.append(last[which])
    return result
