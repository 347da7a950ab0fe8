"""What goes into the FMUs, and how: the kernel, the models made of it, and their export."""
