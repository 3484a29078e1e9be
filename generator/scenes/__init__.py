"""Scenes and contact models: what a user wants computed, and what is known beforehand."""
