"""A short run of every kind of input; the long one is ``python -m tests.fuzz``."""

from __future__ import annotations

import sys

import pytest

from fuzz.kinds import KINDS
from fuzz.runner import run

_SEED = 20261128
_INPUTS = 300


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no alarm there")
@pytest.mark.parametrize("name", KINDS)
def test_every_outcome_is_good_or_documented(tmp_path, name: str) -> None:
    share = KINDS[name].share / sum(kind.share for kind in KINDS.values())
    count = max(3, round(_INPUTS * share))
    counts = run(name, _SEED, range(count), tmp_path)
    assert counts.wrong == {}
    assert counts.good + counts.documented == count
