"""From ground to triangles, chained."""
