"""The live oracle: Microsoft's reference tessellator, as Mesa's software OpenGL carries it.

OpenGL draws patches, and transform feedback catches what the tessellator hands to the evaluation
shader. No display is needed: the context comes through EGL. It all happens in a child process,
so that neither a missing driver nor the OpenGL of other tests can interfere::

    python oracle.py REQUEST.npz ANSWER.npz

OpenGL has no pow2. Its clockwise is seen with v up: our counter-clockwise.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

SPACINGS = {
    "integer": "equal_spacing",
    "fractional_odd": "fractional_odd_spacing",
    "fractional_even": "fractional_even_spacing",
}
DOMAINS = {"quad": "quads", "triangle": "triangles", "isoline": "isolines"}

PACKAGES = "libegl1 libgl1 libgl1-mesa-dri"

FACTORS = 6  # four outer and two inner levels
BATCH = 300  # patches caught at a time
DRAW = 15  # patches of a draw: Mesa numbers a draw's points with 16 bits, a patch has up to 65²
LARGEST_PATCH = 2 * 64 * 64  # primitives

VERTEX = """
#version 430
in vec4 outer;
in vec2 inner;
out vec4 outer_levels;
out vec2 inner_levels;
flat out int number;
void main() {
    outer_levels = outer;
    inner_levels = inner;
    number = gl_VertexID;
}
"""
CONTROL = """
#version 430
layout(vertices = 1) out;
in vec4 outer_levels[];
in vec2 inner_levels[];
flat in int number[];
patch out int patch_number;
void main() {
    for (int i = 0; i < 4; ++i)
        gl_TessLevelOuter[i] = outer_levels[0][i];
    for (int i = 0; i < 2; ++i)
        gl_TessLevelInner[i] = inner_levels[0][i];
    patch_number = number[0];
}
"""
EVALUATION = """
#version 430
layout(%s, %s, cw) in;
patch in int patch_number;
out vec2 coordinate;
flat out int from_patch;
void main() {
    coordinate = gl_TessCoord.xy;
    from_patch = patch_number;
}
"""
CORNER = np.dtype([("coordinate", np.float32, 2), ("patch", np.int32)])


@cache
def problem() -> str | None:
    """Return why there is no live oracle here, in one line; None where there is one."""
    try:
        tessellate("quad", "integer", np.ones((1, 4)), np.ones((1, 2)))
    except OSError as error:
        return f"no live oracle, install it with  apt-get install {PACKAGES}: {error}"
    return None


def tessellate(domain, partitioning, edge_factors, inside_factors=None):
    """Return the primitives (M, corners, 2) uint32 in 16.16, and the patch (M,) of each."""
    factors = np.ones((len(edge_factors), FACTORS), np.float32)
    factors[:, : np.shape(edge_factors)[1]] = edge_factors
    if inside_factors is not None:
        factors[:, 4 : 4 + np.shape(inside_factors)[1]] = inside_factors
    with tempfile.TemporaryDirectory() as folder:
        request, answer = Path(folder, "request.npz"), Path(folder, "answer.npz")
        np.savez(request, domain=domain, partitioning=partitioning, factors=factors)
        child = subprocess.run(
            [sys.executable, __file__, request, answer],
            capture_output=True,
            text=True,
            env=os.environ | {"PYOPENGL_PLATFORM": "egl", "LIBGL_ALWAYS_SOFTWARE": "1"},
        )
        if child.returncode:
            reason = (child.stderr.strip() or f"exit code {child.returncode}").splitlines()[-1]
            raise OSError(reason)
        with np.load(answer) as arrays:
            return arrays["primitives"], arrays["patches"]


def answer(domain: str, partitioning: str, factors: np.ndarray):
    """Draw the patches, in the child process."""
    import moderngl

    # by the names that come without development packages
    libraries = {"libgl": "libGL.so.1", "libegl": "libEGL.so.1"}
    context = moderngl.create_context(standalone=True, backend="egl", require=430, **libraries)
    renderer = context.info["GL_RENDERER"]
    if "llvmpipe" not in renderer:
        raise OSError(f"expected Mesa's llvmpipe, got {renderer}")
    context.simple_framebuffer((4, 4)).use()
    program = context.program(
        vertex_shader=VERTEX,
        tess_control_shader=CONTROL,
        tess_evaluation_shader=EVALUATION % (DOMAINS[domain], SPACINGS[partitioning]),
        varyings=("coordinate", "from_patch"),
    )
    corners = 2 if domain == "isoline" else 3
    caught = context.buffer(reserve=BATCH * LARGEST_PATCH * corners * CORNER.itemsize)
    primitives, patches = [], []
    for start in range(0, len(factors), BATCH):
        batch = np.ascontiguousarray(factors[start : start + BATCH])
        array = context.vertex_array(
            program, [(context.buffer(batch.tobytes()), "4f 2f", "outer", "inner")]
        )
        count = draw(program, array, caught, len(batch), corners)
        read = np.frombuffer(caught.read(count * corners * CORNER.itemsize), CORNER)
        read = read.reshape(-1, corners)
        primitives.append(np.rint(read["coordinate"] * 2.0**16).astype(np.uint32))
        patches.append(start + read["patch"][:, 0])
    return np.concatenate(primitives), np.concatenate(patches)


def draw(program, array, caught, patches: int, corners: int) -> int:
    """Draw `patches` patches of one vertex into the buffer; return how many primitives it caught.

    moderngl's own transform() takes no patches.
    """
    from OpenGL import GL

    GL.glUseProgram(program.glo)
    GL.glBindVertexArray(array.glo)
    GL.glBindBufferBase(GL.GL_TRANSFORM_FEEDBACK_BUFFER, 0, caught.glo)
    GL.glEnable(GL.GL_RASTERIZER_DISCARD)
    GL.glPatchParameteri(GL.GL_PATCH_VERTICES, 1)
    query = int(np.ravel(GL.glGenQueries(1))[0])
    GL.glBeginQuery(GL.GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query)
    GL.glBeginTransformFeedback(GL.GL_LINES if corners == 2 else GL.GL_TRIANGLES)
    for first in range(0, patches, DRAW):
        GL.glDrawArrays(GL.GL_PATCHES, first, min(DRAW, patches - first))
    GL.glEndTransformFeedback()
    GL.glEndQuery(GL.GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN)
    return int(GL.glGetQueryObjectuiv(query, GL.GL_QUERY_RESULT))


if __name__ == "__main__":
    with np.load(sys.argv[1]) as asked:
        made = answer(str(asked["domain"]), str(asked["partitioning"]), asked["factors"])
    np.savez(sys.argv[2], primitives=made[0], patches=made[1])
