"""Targets: CPUs as data, and which of them this machine is."""
