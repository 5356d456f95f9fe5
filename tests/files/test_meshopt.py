"""EXT_meshopt_compression: what meshoptimizer packed comes out as it was, and damage is refused."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.mesh_files import Gltf, y_up
from terrain_lod.errors import FileError
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.files.meshes.meshopt import decode

SIDE = 12
ROW, COLUMN = np.mgrid[: SIDE + 1, : SIDE + 1]
# hills on a square grid: positions in 16 bits, padded to 8 bytes, and two triangles a cell
POINTS = np.stack(
    [COLUMN * 100, ROW * 100, (COLUMN * 7 + ROW * ROW) % 97, np.zeros_like(ROW)], axis=-1
).reshape(-1, 4).astype("<i2")  # fmt: skip
CORNERS = np.arange((SIDE + 1) ** 2).reshape(SIDE + 1, -1)
TRIANGLES = np.stack(
    [CORNERS[:-1, :-1], CORNERS[1:, :-1], CORNERS[:-1, 1:],
     CORNERS[:-1, 1:], CORNERS[1:, :-1], CORNERS[1:, 1:]], axis=-1,
).reshape(-1, 3)  # fmt: skip

# the same, packed by meshoptimizer (attributes version 0, indices version 1)
PACKED = {
    "points": """
        oP//HwDIyMjIyMjIyMjIyMigyMjIyMjIyMjIyMjIoMjIyMjIyMjIyMjIyKDIyMjIyMjIyMjIyMigyMjIyMjIyMjIyM
        jIoMjIyMjIyMjIyMjIyKDIyMjIyMjIyMjIyMigyMjIyMjIyMjIyMjIoMjIyMjIyMjIyMjIyKDIyMjIyMjIyMjIyMig
        yMjIyMjIyMjIyMjIoMjIyMjIyMjIyMjIyKDIyMj//8AAyMjIyMjIyMjIVVUVAgiCMAeCIIwgB4gjCCIHCMIIggcwgi
        CMBwcgiCMIByIIwggHgjCCIAeMIIgjBwcIIgjCBwiCAABVVQUAAAAwyAAADADIAAMAAMgAwAAAyDAAAAzIyAAAAwDI
        AADAAMgAMAAAyAwAAAPIyAAAAMDIEBEBAAIAAAAAAAgAAIAAAAAAAqqqKg7u7u7u7u/upe7u7u7u/u7uoe7u7u/u7u
        7une7u/u7u7u7umf/u7u7u7v7+syyzMO7u7u/u7+7uszTu/u7u/u7v7rM4s+7u7+7+7u7uPLPu/u7u7u7u74F97u7u
        7u7+/u6zSO7u/u7gAAAAswAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA
    """,
    "triangles": """
        4f4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHg
        AeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAe
        AB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB
        4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4AHgAeAB4AHgAeAB4AHgAeAB4AHv4eAB4A
        HgAeAB4AHgAeAB4AHgAeAB4AHvAa8ALwAvAC8ALwAvAC8ALwAvAC8ALwAgB2h1ZneKmGZYlomAFpAAA=
    """,
    "sequence": """
        0QA0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBD
        I0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0
        LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0Lg
        AwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAw
        BDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBD
        I0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0
        LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0Lg
        AwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAw
        BDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBD
        I0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0
        LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAwBDI0Lg
        AwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBC40LgAwBDI0LgAwBDI0LgAw
        BDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBDI0LgAwBAAAAAA=
    """,
}


def unpacked(name: str) -> bytes:
    return base64.b64decode(PACKED[name])


def test_attributes() -> None:
    found = decode(unpacked("points"), len(POINTS), 8, "ATTRIBUTES", "NONE")
    np.testing.assert_array_equal(np.frombuffer(found, "<i2").reshape(-1, 4), POINTS)


@pytest.mark.parametrize("stride", [2, 4])
def test_triangles_and_sequences(stride: int) -> None:
    count = TRIANGLES.size
    found = np.frombuffer(decode(unpacked("triangles"), count, stride, "TRIANGLES", "NONE"),
                          f"<u{stride}").reshape(-1, 3)  # fmt: skip
    # a triangle may begin at another of its corners
    np.testing.assert_array_equal(np.sort(found, axis=1), np.sort(TRIANGLES, axis=1))
    first = np.argmax(found == TRIANGLES[:, :1], axis=1)
    turned = np.take_along_axis(found, (first[:, None] + np.arange(3)) % 3, axis=1)
    np.testing.assert_array_equal(turned, TRIANGLES)
    found = decode(unpacked("sequence"), count, stride, "INDICES", "NONE")
    np.testing.assert_array_equal(np.frombuffer(found, f"<u{stride}"), TRIANGLES.ravel())


def test_filters() -> None:
    # eight-bit octahedral: along x, and folded over to straight down
    codes = np.array([(127, 0, 127, 5), (127, 127, 127, 0)], "i1")
    assert octahedral(codes) == [(127, 0, 0, 5), (0, 0, -127, 0)]
    # exponents are the highest byte, mantissas the lower three, both signed
    words = np.array([3 | (2 << 24), (-3 & 0xFFFFFF) | (0xFF << 24)], "<u4").view("u1")
    packed = raw_attributes(words.reshape(2, 4))
    found = np.frombuffer(decode(packed, 2, 4, "ATTRIBUTES", "EXPONENTIAL"), "<f4")
    assert found.tolist() == [12.0, -1.5]
    # of a quaternion the largest component is left out; the last two bits say which it is
    codes = np.array([(0, 0, 0, 0x7FFC | 3), (0, 0, 0, 0x7FFC)], "<i2")
    packed = raw_attributes(codes.view("u1"))
    found = np.frombuffer(decode(packed, 2, 8, "ATTRIBUTES", "QUATERNION"), "<i2").reshape(2, 4)
    assert found.tolist() == [[0, 0, 0, 32767], [32767, 0, 0, 0]]


def octahedral(codes: np.ndarray) -> list[tuple[int, ...]]:
    packed = raw_attributes(codes.view("u1"))
    found = np.frombuffer(decode(packed, len(codes), 4, "ATTRIBUTES", "OCTAHEDRAL"), "i1")
    return [tuple(row) for row in found.reshape(-1, 4).tolist()]


def raw_attributes(elements: np.ndarray) -> bytes:
    """Return at most 16 elements (n, stride) as the codec takes them in full, unpacked."""
    stride = elements.shape[1]
    body = b""
    for column in elements.T.astype(np.uint8):
        differences = np.diff(column, prepend=column[:1])
        zigzag = ((differences << 1) ^ (0 - (differences >> 7))).astype(np.uint8)
        body += b"\3" + zigzag.tobytes().ljust(16, b"\0")
    return b"\xa0" + body + elements[0].tobytes().rjust(max(32, stride), b"\0")


def packed_gltf(points: bytes, triangles: bytes) -> bytes:
    """Return a .glb whose views are packed."""
    document = Gltf()

    def view(data: bytes, **packed) -> int:
        number = document.view(data)
        own = document.document["bufferViews"][number]
        size = packed["count"] * packed["byteStride"]
        document.document["bufferViews"][number] = {
            "buffer": 0,
            "byteLength": size,
            "byteStride": packed["byteStride"],
            "extensions": {"EXT_meshopt_compression": {**own, **packed}},
        }
        return number

    positions = view(points, count=len(POINTS), byteStride=8, mode="ATTRIBUTES")
    indices = view(triangles, count=TRIANGLES.size, byteStride=2, mode="TRIANGLES")
    del document.document["bufferViews"][indices]["byteStride"]
    position = document.accessor(POINTS[:, :3], positions)
    document.primitive(position, document.accessor(TRIANGLES.ravel().astype("<u2"), indices))
    document.document["extensionsRequired"] = ["EXT_meshopt_compression", "KHR_mesh_quantization"]
    return document.glb()


def test_a_packed_gltf(tmp_path) -> None:
    path = tmp_path / "packed.glb"
    path.write_bytes(packed_gltf(unpacked("points"), unpacked("triangles")))
    mesh = load_mesh(path)
    assert len(mesh.triangles) == len(TRIANGLES)
    found = mesh.vertices + mesh.origin
    x, y, z = POINTS[:, :3].astype(float).T
    np.testing.assert_array_equal(y_up(found), np.stack([x, y, z], axis=1))
    path.write_bytes(packed_gltf(unpacked("points")[:-40], unpacked("triangles")))
    with pytest.raises(FileError, match="compressed attributes"):
        load_mesh(path)


@settings(deadline=None, max_examples=150)
@given(
    name=st.sampled_from(["points", "triangles", "sequence"]),
    place=st.integers(0, 400),
    value=st.integers(0, 255),
    cut=st.integers(0, 60),
)
def test_damage_is_refused_or_gives_as_much_as_was_asked(name, place, value, cut) -> None:
    data = bytearray(unpacked(name))
    data[place % len(data)] = value
    count, stride, mode = {
        "points": (len(POINTS), 8, "ATTRIBUTES"),
        "triangles": (TRIANGLES.size, 4, "TRIANGLES"),
        "sequence": (TRIANGLES.size, 4, "INDICES"),
    }[name]
    try:
        found = decode(bytes(data[: len(data) - cut]), count, stride, mode, "NONE")
    except ValueError:
        return
    assert len(found) == count * stride


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((b"", 4, 8, "ATTRIBUTES", "NONE"), "do not begin as they must"),
        ((b"\xa0" * 9, 4, 8, "ATTRIBUTES", "NONE"), "too short"),
        ((b"\xa0" * 9, 10**12, 8, "ATTRIBUTES", "NONE"), "cannot be 1000000000000 elements"),
        ((b"\xe1", 3, 4, "TRIANGLES", "NONE"), "do not begin as they must"),
        ((b"\xd1", 3, 4, "INDICES", "NONE"), "do not begin as they must"),
        ((b"\xd1", 3, 4, "WORDS", "NONE"), "unknown mode 'WORDS'"),
    ],
)
def test_what_is_no_packed_data_is_refused(arguments, message) -> None:
    with pytest.raises(ValueError, match=message):
        decode(*arguments)
