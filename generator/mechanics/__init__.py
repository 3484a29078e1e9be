"""Mechanics of a solid ball that is touched at some points, whatever touches it."""
