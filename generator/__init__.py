"""carom's generator: facts -> expressions -> variants -> C++ -> verified -> timed -> chosen."""

__version__ = "0.1.0"
