"""Questions to meshes in float64."""
