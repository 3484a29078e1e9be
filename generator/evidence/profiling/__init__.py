"""What a kernel does while it runs: operations, where its time goes, which branches it misses."""
