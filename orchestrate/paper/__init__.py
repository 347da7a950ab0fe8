"""Recompute the paper: the plan of its figures, its claims with verdicts, and a report."""
