"""A made-up impact, of a puck without friction against a wall: what adding one takes, as a test."""
