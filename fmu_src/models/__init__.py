"""The models: variable tables, texts and reference results.

A folder each with variable table, texts, documentation and reference results.
"""
