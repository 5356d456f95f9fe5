"""A small linker, for PoCL alone."""
