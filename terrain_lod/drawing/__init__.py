"""Pictures of meshes and of patterns."""
