"""Impacts: what collides, as mechanics and data."""
