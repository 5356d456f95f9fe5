"""Bundled ground, read as package data by ``terrain_lod.files.rasters.samples``."""
