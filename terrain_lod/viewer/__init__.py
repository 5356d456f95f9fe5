"""Windows and pages that move."""
