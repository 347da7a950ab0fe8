"""Which function draws a result, by its attribute `question`; :mod:`.plot` chooses among them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import xarray as xr
from matplotlib.figure import Figure

from ..errors import InputError

Drawer = TypeVar("Drawer", bound=Callable[..., Figure])
DRAW: dict[str, Callable[..., Figure]] = {}  # by kind: the function that made the result
PARTNERS: dict[str, str] = {}  # by kind: what may be in one picture with it
MORE, BRANCHES = "more of them", "branches"
BONDED, OTHER = "the bonded structure's", "the other structure's"


def draws(*kinds: str, partner: str = "") -> Callable[[Drawer], Drawer]:
    """Return a decorator that registers what draws results of some kinds, and who may join them."""

    def register(draw: Drawer) -> Drawer:
        DRAW.update(dict.fromkeys(kinds, draw))
        PARTNERS.update(dict.fromkeys(kinds, partner))
        return draw

    return register


def kind_of(answer: Any) -> str:
    """Return the kind of a result; an empty text if it does not say."""
    attributes = answer.attrs if isinstance(answer, xr.Dataset) else {}
    # older files have only the text of the call
    before = str(attributes.get("call", "")).partition("(")[0]
    return str(attributes.get("question") or attributes.get("analysis") or before)


def require_kind(answer: Any) -> str:
    kind = kind_of(answer)
    if not kind:
        what = type(answer).__name__
        raise InputError(
            f"cannot plot {what}; expected results of one of {', '.join(sorted(DRAW))}"
        )
    return kind
