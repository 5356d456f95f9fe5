"""Ways to make many triangles of few, compared: time and bytes, level by level.

    python benchmarks/amplification.py [--levels 1 3 ... 15] [--rounds 5] [--out amplification.svg]

One cube, twenty cubes, a character of about 2,000 triangles and twenty of it, each copy turned and
placed on its own, at every odd level, in each of the ways of
``amplify/ways.py``. Prints device times of a frame (medians of interleaved rounds) and
bytes, says which way wins where, and checks the finding that stored triangles need about 200 times
the memory at level 11; draws it all.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
from amplify.ways import WAYS, Amplifier, Scene, triangles_of
from character import character

import terrain_lod as tl
from measure import interleaved

LEVELS = tuple(range(1, 16, 2))
# what the thesis calls them, and how they are drawn
CASES = {
    "fixed": ("1, one level", "C0", "-"),
    "direct": ("1, any level", "C0", "--"),
    "borders": ("2, border emitters", "C1", "-"),
    "quads": ("3, quad emitters", "C3", "-"),
    "stored": ("4, stored", "C2", "-"),
    "indexed": ("5, tessellator", "C4", "-"),
    "passed": ("6, and pass-through", "C4", "--"),
}
# a vertex of the control mesh: position and normal
VERTEX_BYTES = 24


@dataclass(frozen=True)
class Cost:
    """What a way costs at a level: seconds a frame, bytes kept, on the way and of the triangles."""

    seconds: float
    kept: int
    working: int
    drawn: int


def cube() -> tl.Mesh:
    """Return a cube of 12 triangles whose faces have vertices of their own."""
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    vertices = corners[np.array(faces).ravel()]
    normals = np.repeat([corners[list(face)].mean(axis=0) for face in faces], 4, axis=0)
    corner = 4 * np.arange(6)[:, None] + np.array([0, 1, 2, 0, 2, 3])
    triangles = corner.reshape(-1, 3).astype(np.int32)
    return tl.Mesh(vertices, normals.astype(np.float32), triangles)


def crowd(count: int) -> np.ndarray:
    """Return transforms that turn copies about z and stand them in rows of five; (count, 3, 4)."""
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    transforms = np.zeros((count, 3, 4))
    transforms[:, 0, 0] = transforms[:, 1, 1] = np.cos(angles)
    transforms[:, 1, 0], transforms[:, 0, 1] = np.sin(angles), -np.sin(angles)
    transforms[:, 2, 2] = 1
    transforms[:, 0, 3], transforms[:, 1, 3] = 2.5 * (np.arange(count) % 5), np.arange(count) // 5
    return transforms


def costs(scene: Scene, level: int, rounds: int) -> dict[str, Cost]:
    """Return what each way costs; without those that the device has no room for."""
    ready: dict[str, Amplifier] = {}
    frames = {}
    for way, prepare in WAYS.items():
        try:
            amplifier = prepare(scene, level)
            frame = amplifier.draw()
        except tl.DeviceMemoryError as error:
            print(f"  {way} at level {level}: {error}")
            continue
        ready[way], frames[way] = amplifier, (frame.working, frame.nbytes)
        del frame
    times = interleaved(scene.device, {way: one.draw for way, one in ready.items()}, rounds)
    return {
        way: Cost(median(seconds), ready[way].kept, *frames[way]) for way, seconds in times.items()
    }


def print_table(name: str, found: dict[int, dict[str, Cost]]) -> None:
    """Print a scene's times and bytes, a row a way, a column a level."""
    print(f"\n{name}: milliseconds a frame")
    print(f"  {'level':22}" + "".join(f"{level:>10}" for level in found))
    for way, (label, _, _) in CASES.items():
        cells = [_cell(at.get(way), lambda cost: cost.seconds * 1e3) for at in found.values()]
        print(f"  {label:22}" + "".join(cells))
    winners = [min(at, key=lambda way: at[way].seconds) for at in found.values()]
    print(f"  {'fastest':22}" + "".join(f"{way:>10}" for way in winners))
    unstored = [
        min((way for way in at if way != "stored"), key=lambda way: at[way].seconds)
        for at in found.values()
    ]
    print(f"  {'on the fly':22}" + "".join(f"{way:>10}" for way in unstored))
    for what in ("kept", "working", "drawn"):
        print(f"{name}: KiB {_MEANING[what]}")
        for way, (label, _, _) in CASES.items():
            cells = [
                _cell(at.get(way), lambda c, w=what: getattr(c, w) / 1024) for at in found.values()
            ]
            print(f"  {label:22}" + "".join(cells))


_MEANING = {
    "kept": "kept between frames, besides the mesh",
    "working": "needed while a frame is made",
    "drawn": "of the frame's triangles",
}


def _cell(cost: Cost | None, value) -> str:
    return f"{'-':>10}" if cost is None else f"{value(cost):10.4g}"


def print_finding(mesh: tl.Mesh, copies: int, level: int) -> None:
    """Compare the memory of stored triangles with that of the control mesh, as the thesis does."""
    control = copies * len(mesh.triangles) * 3 * VERTEX_BYTES
    stored = control * triangles_of(level)
    shared = copies * (len(mesh.vertices) * VERTEX_BYTES + mesh.triangles.nbytes)
    print(
        f"\nstored at level {level}, {copies} copies of {len(mesh.triangles)} triangles:\n"
        f"  {stored / 2**20:8.1f} MiB of stored vertices\n"
        f"  {control / 2**20:8.1f} MiB of the control mesh, vertices unshared as in the thesis: "
        f"{stored / control:.0f} times, {(stored + control) / control:.0f} with the mesh kept\n"
        f"  {shared / 2**20:8.1f} MiB of the control mesh, vertices shared: "
        f"{stored / shared:.0f} times\n"
        "  the thesis says roughly 200 times; level L makes (3 L² - 1) / 2 triangles of one, "
        f"{triangles_of(level)} here"
    )


def plot(scenes: dict[str, dict[int, dict[str, Cost]]], path: Path) -> None:
    """Draw times a scene, and the memory of the last, as the thesis does."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams["svg.hashsalt"] = "amplification"
    rows = math.ceil((len(scenes) + 1) / 2)
    figure, axes = plt.subplots(rows, 2, figsize=(11, 4 * rows), layout="constrained")
    for axis, (name, found) in zip(axes.flat, scenes.items(), strict=False):
        _draw(axis, found, lambda cost: cost.seconds * 1e3)
        axis.set(title=name, ylabel="ms a frame")
    name, found = list(scenes.items())[-1]
    memory = axes.flat[len(scenes)]
    _draw(memory, found, lambda cost: (cost.kept + cost.working) / 2**20)
    memory.set(title=f"{name}: kept and on the way", ylabel="MiB")
    for axis in axes.flat[len(scenes) + 1 :]:
        axis.set_axis_off()
        axis.legend(*memory.get_legend_handles_labels(), loc="center", frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    print(f"\nwrote {path}")


def _draw(axis, found: dict[int, dict[str, Cost]], value) -> None:
    for way, (label, colour, line) in CASES.items():
        points = [(level, value(at[way])) for level, at in found.items() if way in at]
        if points:
            axis.plot(*zip(*points, strict=True), line, color=colour, marker=".", label=label)
    axis.set_yscale("log")
    axis.set_xticks(list(found))
    axis.set_xlabel("level")
    axis.grid(alpha=0.3)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run all scenes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--levels", type=int, nargs="+", default=LEVELS, help="odd")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--copies", type=int, default=20, help="of the crowded scenes")
    parser.add_argument("--out", type=Path, default=Path("out/amplification.svg"))
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args(arguments)
    device = tl.Device.open(options.device)
    print(device.info)
    figure, many = character(), options.copies
    scenes = {}
    for name, mesh, copies in (
        ("1 cube", cube(), 1),
        (f"{many} cubes", cube(), many),
        (f"1 character of {len(figure.triangles)} triangles", figure, 1),
        (f"{many} characters", figure, many),
    ):
        scene = Scene.upload(mesh, crowd(copies), device)
        scenes[name] = {level: costs(scene, level, options.rounds) for level in options.levels}
        print_table(name, scenes[name])
    print_finding(figure, many, 11)
    plot(scenes, options.out)


if __name__ == "__main__":
    main()
