"""Levels of detail, compared on paper."""
