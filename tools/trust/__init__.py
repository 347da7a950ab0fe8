"""Ledger of trust: campaigns that try to break the project's promises, and their results."""
