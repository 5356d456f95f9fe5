"""What lets patches stay as they are from one mesh to the next."""

from __future__ import annotations

import threading
from typing import Any

from ..numbered import Number

_HYSTERESIS = Number(0.25, low=0.0, high=10.0)


class Steady:
    """Meshes, one after the other, whose patches change late: for a camera that moves.

    Where a view changes a little, the errors that patches may have change a little, and many
    patches with them. This remembers what each was allowed in the last mesh. A patch is held to
    that until it is more than it may have, or less by a share of `hysteresis`. All promises are
    kept; only some patches are finer than they would have to be.

    Parameters
    ----------
    hysteresis : float, optional
        Width of the band, 0 to 10. At 0 every mesh is as if it were the first.

    Raises
    ------
    InputError
        If `hysteresis` is no such number.

    Examples
    --------
    >>> steady = Steady(0.25)
    >>> meshes = [terrain.mesh(camera, steady=steady) for camera in path]      # doctest: +SKIP

    Notes
    -----
    One for each view: it goes on with the last mesh that it was given to. Of a terrain that was
    updated, or another, it begins anew.
    """

    def __init__(self, hysteresis: float = 0.25) -> None:
        self.hysteresis = _HYSTERESIS.checked("hysteresis", hysteresis)
        # of which quadtree, and what its nodes were in the last mesh
        self.of: object = None
        self.marks: Any = None
        self.lock = threading.Lock()

    def __repr__(self) -> str:
        return f"Steady({self.hysteresis:g})"
