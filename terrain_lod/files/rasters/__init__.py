"""Ground read from raster files."""
