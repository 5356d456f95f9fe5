"""A frame loop
============

Terrain in an engine of your own, here moderngl: buffers that stay, and of each mesh only what is
new is written into them, from the memory that it was made in. Needs ``pip install moderngl``.
"""

from time import perf_counter

import moderngl
import numpy as np
from PIL import Image

import terrain_lod as tl

SIZE, FRAMES, ROOM = (640, 360), 12, 1 << 24  # bytes of a buffer
BLOCK = 1 << 14  # bytes that are compared, and written, at a time
VERTEX = """#version 330
uniform mat4 seen; in vec3 at, normal; out float light;
void main() { gl_Position = seen * vec4(at, 1); light = dot(normal, vec3(-0.4, 0.4, 0.82)); }"""
FRAGMENT = """#version 330
in float light; out vec4 colour; void main() { colour = vec4(light * vec3(0.9, 0.85, 0.7), 1); }"""


def take(buffer: moderngl.Buffer, has: np.ndarray, array: tl.DeviceArray) -> int:
    """Write what differs from what a buffer has; return how many bytes that was."""
    seen = array.host() if array.device.is_gpu else array.view()  # a CPU needs no copy
    new, written = seen.reshape(-1).view(np.uint8), 0
    for start in range(0, len(new), BLOCK):
        block, had = (values[start : start + BLOCK] for values in (new, has[: len(new)]))
        if (block != had).any():
            had[:] = block
            buffer.write(block, offset=start)
            written += len(block)
    return written


def seen_by(camera: tl.Camera, origin: np.ndarray) -> bytes:
    """Return OpenGL's matrix for points relative to an origin; near is 1, far infinite."""
    right, upward, forward = camera.axes / np.array([[*camera.half_extents, 1.0]]).T
    rows = np.stack([right, upward, forward, forward])
    shift = -rows @ np.subtract(camera.eye, origin) - (0, 0, 2, 0)
    return np.column_stack([rows, shift]).T.astype("f4").tobytes()


context = moderngl.create_context(standalone=True, backend="egl")  # without a window
program = context.program(VERTEX, FRAGMENT)
points, normals, triangles = buffers = [context.buffer(reserve=ROOM) for _ in range(3)]
scene = context.vertex_array(program, [(points, "3f", "at"), (normals, "3f", "normal")], triangles)
(target := context.simple_framebuffer(SIZE)).use()
context.enable(moderngl.DEPTH_TEST)

ground = tl.sample("ridge")
terrain, camera, steady = tl.Terrain(ground), tl.default_camera(ground), tl.Steady()
has, (x, y, z), lod = np.zeros((3, ROOM), np.uint8), camera.eye, tl.ScreenErrorLod(2.0)
terrain.mesh_on_device(camera, lod=lod)  # builds kernels
copied, made, began = 0, 0, perf_counter()
for frame in range(FRAMES):  # flies on, then stands still
    view = tl.Camera((x + 20.0 * min(frame, FRAMES // 2), y, z), camera.target, size=SIZE)
    mesh = terrain.mesh_on_device(view, lod=lod, steady=steady)
    arrays = (mesh.vertices, mesh.normals, mesh.triangles)
    copied += sum(map(take, buffers, has, arrays))
    made += sum(array.nbytes for array in arrays)
    program["seen"].write(seen_by(view, mesh.origin))
    target.clear(0.6, 0.75, 0.9)
    scene.render(vertices=mesh.triangles.size)
picture = Image.frombytes("RGB", SIZE, target.read())
rate = FRAMES / (perf_counter() - began)
print(f"{rate:.1f} frames a second; copied into the engine: {copied:,} of {made:,} bytes")
picture.transpose(Image.Transpose.FLIP_TOP_BOTTOM).save("frame_loop.png")
