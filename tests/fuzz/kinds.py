"""All kinds of input, one a row."""

from __future__ import annotations

from typing import Final

from fuzz import (
    cameras,
    commands,
    endurance,
    functions,
    grounds,
    meshes,
    patches,
    rasters,
)
from fuzz.kind import Kind

KINDS: Final[dict[str, Kind]] = {
    "ground": Kind(rasters.trial, share=40),
    "meshes": Kind(meshes.trial, share=30),
    "meshes read in a child": Kind(meshes.trial_in_child, share=1),
    "patches": Kind(patches.trial, share=5),
    "cameras": Kind(cameras.trial, share=5),
    # the first of a kind compiles kernels
    "odd ground": Kind(grounds.trial, share=10, seconds=120),
    "killed writers": Kind(endurance.trial_kills, share=1),
    "two threads": Kind(endurance.trial_threads, share=1, seconds=60),
    # ten inputs are 500 rounds, and as many before them
    "rounds without growth": Kind(endurance.trial_rounds, share=0.1, seconds=120),
    "functions": Kind(functions.trial, share=50),
    "commands": Kind(commands.trial, share=10),
}
