"""Sources of the FMUs: the kernels, the models made of them, and their export."""
