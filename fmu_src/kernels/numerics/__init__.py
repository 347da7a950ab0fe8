"""What the kernels share: elementary functions with the same bits on every machine, first roots."""
