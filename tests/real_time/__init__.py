"""Measure the FMU on real-time targets, for the manual: ``python -m tests.real_time``."""
