"""The prefix sum in NumPy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def exclusive_scan(counts: npt.ArrayLike) -> npt.NDArray[np.int64]:
    """Return the sums of the counts before each, then of all; (n,) gives (n + 1,)."""
    return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
