"""Slots of a flat memory, numbered in the order in which they are declared.

A kernel's ``memory.py`` is its one declaration: names, sizes, meanings. The numbers are plain
module-level integers, which are constants of the translated code. This runs at import only; it is
no part of the numeric path.
"""


class Slots:
    """Counter that numbers the slots of a flat memory.

    Examples
    --------
    >>> slot = Slots()
    >>> ALONE, PAIR, LAST = slot(), slot(2), slot()
    >>> (ALONE, PAIR, LAST), slot.used
    ((0, 1, 3), 4)
    """

    def __init__(self) -> None:
        self.used = 0

    def __call__(self, size: int = 1) -> int:
        """Reserve the next ``size`` slots and return the first of them."""
        first = self.used
        self.used += size
        return first
