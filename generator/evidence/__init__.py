"""What is known of a kernel: errors, times, counts, and the worst that a search finds."""
