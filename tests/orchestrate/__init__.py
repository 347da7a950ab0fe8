"""Tests of the orchestration: its command line as processes, its parts as calls."""
