"""Mechanics: SymPy derives the collision from contact points, impulses and their moments."""
