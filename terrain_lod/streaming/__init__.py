"""Terrain over a pyramid: what a view needs of it is held, and no more."""
