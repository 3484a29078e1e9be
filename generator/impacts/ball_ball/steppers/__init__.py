"""Steppers of two balls: the fixed-step scheme, exact steps, and fixed steps with a certificate."""
