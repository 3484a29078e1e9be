"""The variant registry: option axes, legal combinations, names and presets."""
