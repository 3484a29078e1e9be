"""Runge-Kutta tableaus in exact rationals: facts, as the literature gives them."""
