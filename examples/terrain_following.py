"""Terrain following
=================

Fly low over a mesh and stay clear of it: heights below and rays ahead, each in one call.
"""

import numpy as np
from matplotlib.figure import Figure

import terrain_lod as tl

CLEARANCE = 60.0  # metres above what is drawn

ground = tl.sample("canyon")
terrain = tl.Terrain(ground)
drawn = tl.MeshQueries(terrain.mesh(lod=tl.MaxErrorLod(5.0)))

# a way across the ground, a point every few metres
x, y, _ = ground.centre
width, depth = ground.extent
along = np.linspace(-0.4, 0.4, 2000)
way = np.column_stack([x + along * width, y + 0.1 * depth * np.sin(9 * along)])

# as high as what is drawn within a hundred points, smoothed; never lower than asked
below = drawn.height_at(way)
ahead = np.lib.stride_tricks.sliding_window_view(np.pad(below, 100, mode="edge"), 201)
flight = np.column_stack([way, ahead.max(axis=1) + CLEARANCE])
flight[:, 2] = np.convolve(np.pad(flight[:, 2], 50, mode="edge"), np.ones(101) / 101, "valid")
flight[:, 2] = np.maximum(flight[:, 2], below + CLEARANCE)

# what the pilot would meet by flying straight on and slightly down
heading = np.gradient(way, axis=0)
heading /= np.linalg.norm(heading, axis=1, keepdims=True)
hits = drawn.cast(flight, np.column_stack([heading, np.full(len(way), -0.2)]))
nearest = np.nanargmin(hits.distance)

print(f"clearance of {np.min(flight[:, 2] - below):.1f} m or more above {drawn}")
print(f"{hits}, the nearest {hits.distance[nearest]:.0f} m ahead")
print(f"  tile {hits.tile[nearest]}, triangle {hits.triangle[nearest]}")
print(f"  its factors {hits.factor[nearest]}, its normal {hits.normal[nearest].round(2)}")
# a promise is one about samples: those nearest to the way
samples = ground.origin + np.round((way - ground.origin) / ground.spacing) * ground.spacing
off = np.abs(drawn.height_at(samples) - terrain.height_at(samples)).max()
print(f"what is drawn is off the ground by {off:.2f} m at most")
assert off <= 5.0

figure = Figure(figsize=(10, 3.6), layout="constrained")
axes = figure.subplots()
kilometres = (way[:, 0] - way[0, 0]) / 1000
axes.fill_between(kilometres, below, below.min() - 20, color="#b9a27f", label="what is drawn")
axes.plot(kilometres, flight[:, 2], color="#1d5b7a", label="flight")
axes.set(xlabel="kilometres to the east", ylabel="metres", xlim=(kilometres[0], kilometres[-1]))
axes.legend(loc="upper left", frameon=False)
figure.savefig("terrain_following.png", dpi=110)
