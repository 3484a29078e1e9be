"""Records: times of kernels on named CPUs as text, and what they tell of a choice."""
