"""Slots of :mod:`.kernel_like`."""

COUNT, OUT, SCRATCH, LIMIT, RESULT, SIZE = 0, 1, 4, 5, 6, 7
