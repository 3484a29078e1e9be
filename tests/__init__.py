"""Tests by the rooms of generator/; `kernels` holds what every emitted kernel must do."""
