"""Ground and meshes, in and out."""
