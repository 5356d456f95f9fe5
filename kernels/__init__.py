"""OpenCL C sources, read as package data by ``terrain_lod.device``."""
