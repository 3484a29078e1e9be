"""The report: what a sweep found and why, measured, gathered and laid out as one page."""
