"""Developer tools that are not shipped: generated assets, benchmarks, benches, pictures."""
