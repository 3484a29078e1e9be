"""Steppers: Runge-Kutta tableaus in exact rationals, and what each error budget asks of them."""
