"""The models as the world sees them.

A folder each with variable table, texts, documentation and reference results.
"""
