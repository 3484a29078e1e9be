"""What users of other languages get: the kernels that they carry and how these are found."""
