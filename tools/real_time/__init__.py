"""Measure the FMU on real-time targets, for the manual: ``python -m tools.real_time``."""
