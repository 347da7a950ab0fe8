"""The models as the world sees them: a folder each with variable table, texts, documentation and
reference results.
"""
