"""From factors to patterns."""
