"""Numerics of all kernels: sine, exponential, first roots of quintics; slots of the memory."""
