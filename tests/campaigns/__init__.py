"""Campaigns: promises attacked from a seed, as slow tests.

``python -m pytest tests/campaigns -m slow --seed 95 --budget 2000``. Without ``--budget`` each does
a few seconds' work; the budget counts what the campaign's ``budget`` mark counts. A finding becomes
a quick test where it belongs, then is mended; ``docs/trust.md`` has the table of each release.
"""
