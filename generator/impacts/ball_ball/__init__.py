"""Two balls: contacts, contact models, parameters, scenes and what ends the collision."""
