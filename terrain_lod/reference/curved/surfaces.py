"""Parametric surfaces and curves in float64: positions from their textbook formulas.

Normals and tangents are differences of positions, so that they know nothing of the kernels'
derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Numbers = Mapping[str, float]

_STEP: Final = 1e-6


def _power(x: Array, power: float) -> Array:
    return np.sign(x) * np.abs(x) ** power


def _sphere(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    ring, angle = n["radius"] * np.sin(np.pi * v), 2 * np.pi * u
    return ring * np.cos(angle), ring * np.sin(angle), -n["radius"] * np.cos(np.pi * v)


def _torus(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, tube = 2 * np.pi * u, 2 * np.pi * v
    ring = n["radius"] + n["tube"] * np.cos(tube)
    return ring * np.cos(angle), ring * np.sin(angle), n["tube"] * np.sin(tube)


def _moebius(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, across = 2 * np.pi * u, n["width"] * (v - 0.5)
    ring = n["radius"] + across * np.cos(angle / 2)
    return ring * np.cos(angle), ring * np.sin(angle), across * np.sin(angle / 2)


def _klein(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, t = 2 * np.pi * u, 2 * np.pi * v
    half, size = angle / 2, n["size"]
    ring = n["radius"] + size * (np.cos(half) * np.sin(t) - np.sin(half) * np.sin(2 * t))
    height = size * (np.sin(half) * np.sin(t) + np.cos(half) * np.sin(2 * t))
    return ring * np.cos(angle), ring * np.sin(angle), height


def _helicoid(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, along = 2 * np.pi * n["turns"] * v, n["radius"] * (2 * u - 1)
    return along * np.cos(angle), along * np.sin(angle), n["pitch"] * n["turns"] * v


def _seashell(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, t = 2 * np.pi * n["turns"] * u, 2 * np.pi * v
    scale = n["growth"] ** (n["turns"] * (u - 1))
    ring = scale * (1 + n["tube"] * np.cos(t))
    height = scale * (n["tube"] * np.sin(t) - n["height"])
    return ring * np.cos(angle), ring * np.sin(angle), height


def _superquadric(u: Array, v: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle, up = 2 * np.pi * u, np.pi * (v - 0.5)
    ring = n["radius"] * _power(np.cos(up), n["along"])
    x, y = (ring * _power(f(angle), n["across"]) for f in (np.cos, np.sin))
    return x, y, n["radius"] * _power(np.sin(up), n["along"])


def _helix(t: Array, n: Numbers) -> tuple[Array, Array, Array]:
    angle = 2 * np.pi * n["turns"] * t
    height = n["pitch"] * n["turns"] * t
    return n["radius"] * np.cos(angle), n["radius"] * np.sin(angle), height


def _torus_knot(t: Array, n: Numbers) -> tuple[Array, Array, Array]:
    return _torus(n["p"] * t, n["q"] * t, n)


def _lissajous(t: Array, n: Numbers) -> tuple[Array, Array, Array]:
    turn = 2 * np.pi * t
    x, y, z = (n["x"] * turn, n["y"] * turn - np.pi / 2, n["z"] * turn - np.pi / 4)
    return n["size"] * np.cos(x), n["size"] * np.cos(y), n["size"] * np.cos(z)


Formula = Callable[[Array, Array, Numbers], tuple[Array, Array, Array]]
"""x, y and z of a surface at u and v from 0 to 1, from the numbers that shape it."""

SURFACES: Final[dict[str, Formula]] = {
    "sphere": _sphere,
    "torus": _torus,
    "moebius": _moebius,
    "klein": _klein,
    "helicoid": _helicoid,
    "seashell": _seashell,
    "superquadric": _superquadric,
}
CURVES: Final[dict[str, Callable[[Array, Numbers], tuple[Array, Array, Array]]]] = {
    "helix": _helix,
    "torus_knot": _torus_knot,
    "lissajous": _lissajous,
}


def surface(shape: str | Formula, u: Array, v: Array, numbers: Numbers) -> tuple[Array, Array]:
    """Return positions and unit normals (N, 3) at u and v; NaN where there is no normal."""
    formula = SURFACES[shape] if isinstance(shape, str) else shape

    def at(u: Array, v: Array) -> Array:
        return np.stack(formula(u, v, numbers), axis=1)

    along_u, along_v = (
        (at(u + a, v + b) - at(u - a, v - b)) / (2 * _STEP) for a, b in ((_STEP, 0), (0, _STEP))
    )
    normals = np.cross(along_u, along_v)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return at(u, v), normals / np.where(lengths > 1e-4, lengths, np.nan)


def curve(name: str, t: Array, numbers: Numbers) -> tuple[Array, Array]:
    """Return positions and unit tangents (N, 3) at t."""
    at = CURVES[name]
    ahead, behind = (np.stack(at(t + step, numbers), axis=1) for step in (_STEP, -_STEP))
    tangents = ahead - behind
    return np.stack(at(t, numbers), axis=1), tangents / np.linalg.norm(
        tangents, axis=1, keepdims=True
    )
