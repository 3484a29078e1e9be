"""Figures of the documentation: what is measured for them, and how it is drawn."""
