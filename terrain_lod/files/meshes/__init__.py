"""Meshes read, and meshes written."""
