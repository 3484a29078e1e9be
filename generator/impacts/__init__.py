"""Impacts: what collides, as mechanics and data."""

DEFAULT = "ball-ball"  # where a command is not told; here, so that --help loads no impact
