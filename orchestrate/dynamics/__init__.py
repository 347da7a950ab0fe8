"""Dynamics of the structure: settled responses, carried deviations, and periodic orbits."""
