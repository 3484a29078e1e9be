"""Sweep: the whole registry explored for one CPU, every trial kept as a record."""
