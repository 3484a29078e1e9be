"""Steppers: how the impulse is stepped, lowered to the parts that templates lay out."""
