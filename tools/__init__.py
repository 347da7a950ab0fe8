"""What is done in a clone only, and not shipped: assets of the FMUs, and benchmarks."""
