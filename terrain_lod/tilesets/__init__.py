"""Ground as tiles for the web: pyramids of meshes and of pictures, each with its measured error."""
