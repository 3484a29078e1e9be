"""The search for the input with the largest error of a kernel."""
