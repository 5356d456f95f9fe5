"""Triangles, and what they are asked."""
