"""Mechanics of a solid sphere that is touched at some points, whatever touches it."""
