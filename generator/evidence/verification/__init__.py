"""Verdicts on kernels: how far what they compute is from what must come out."""
