"""Choice: which variants are tried, what they are worth, and which one is kept."""
