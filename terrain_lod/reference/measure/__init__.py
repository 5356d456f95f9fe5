"""Errors of meshes in float64."""
