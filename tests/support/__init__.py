"""What several tests need, and the programs that they start."""
