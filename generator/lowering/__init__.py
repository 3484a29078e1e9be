"""Lowering: SymPy expressions become ordered C++ statements with counted operations."""
