"""Curved patches in float64."""
