"""Errors as bytes are never less than the errors, and hardly more."""

from __future__ import annotations

import numpy as np

from terrain_lod.pyramid.codes import decode, encode


def test_bytes_are_rounded_up_and_hardly_so() -> None:
    errors = 10.0 ** np.random.default_rng(0).uniform(-3.5, 5, 10_000)
    for values in (errors, errors.astype(np.float32), decode(np.arange(1, 255, dtype=np.uint8))):
        back = decode(encode(values))
        assert (back >= values).all()
        assert (back <= values * 1.0906).all()


def test_ends() -> None:
    assert decode(encode(np.array([0.0, np.inf, 1e30]))).tolist() == [0.0, np.inf, np.inf]
    assert encode(np.array([0.0, 1e-30])).tolist() == [0, 1]
