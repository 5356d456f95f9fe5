"""Ground with detail in float64."""
