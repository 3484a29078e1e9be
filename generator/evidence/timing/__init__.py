"""Timing of kernels: the C++ tool that does it, its plans, and ratios out of its measurements."""
