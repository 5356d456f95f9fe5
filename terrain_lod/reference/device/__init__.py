"""Sums in whole numbers."""
