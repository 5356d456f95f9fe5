"""The stages again in float64 NumPy: the living definition that every kernel is compared with."""
