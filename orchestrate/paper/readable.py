"""Make sentences readable: words and signs in place of nan, True, inf and +-."""

from __future__ import annotations

import re

SIGNS = {"+-": "±", "<=": "≤", ">=": "≥"}
MEANT = {"nan": "not found", "True": "yes", "False": "no", "inf": "without bound"}


def plain(text: str) -> str:
    """Return a sentence with nan, True, inf and +- replaced by words and signs.

    Examples
    --------
    >>> plain("none: True; width nan +- 0.1")
    'none: yes; width not found ± 0.1'
    """
    text = re.sub(rf"\b({'|'.join(MEANT)})\b", lambda match: MEANT[match[0]], text)
    for sign, better in SIGNS.items():
        text = text.replace(sign, better)
    return text
