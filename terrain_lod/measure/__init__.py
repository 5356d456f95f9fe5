"""How far a mesh is from the ground, in metres and in pixels, and whether it is closed."""
