"""A ball and a cushion: contacts, contact models, parameters, scenes and what ends the impact."""
