"""Compilers, their flags, built libraries and llvm-mca: text in, machine code or figures out."""
