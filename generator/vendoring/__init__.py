"""Vendoring: kernels as a folder that builds alone in another project."""
