"""What the steppers of all impacts share; each impact's own lie in its folder."""
