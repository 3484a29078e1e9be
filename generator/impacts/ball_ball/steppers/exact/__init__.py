"""Adaptive Runge-Kutta steps of the reduced system, and the control of their length."""
