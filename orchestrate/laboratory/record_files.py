"""Stub."""

read_record = write_record = None
