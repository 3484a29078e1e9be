"""Fixed steps for collisions that a bound, known beforehand, says they are exact enough for."""
