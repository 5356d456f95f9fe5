"""Stages of terrain in float64."""
