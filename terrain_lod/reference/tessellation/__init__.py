"""Patterns in whole numbers."""
