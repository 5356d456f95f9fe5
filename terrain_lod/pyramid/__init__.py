"""Ground larger than memory: a pyramid on disk, how it is built, and the terrain over it."""
