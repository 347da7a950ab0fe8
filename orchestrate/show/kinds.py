"""Which function draws a result, by its attribute `question`; :mod:`.plot` chooses among them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import xarray as xr
from matplotlib.figure import Figure

from ..errors import InputError

Drawer = TypeVar("Drawer", bound=Callable[..., Figure])
DRAW: dict[str, Callable[..., Figure]] = {}  # by kind: the function that made the result
TOGETHER: dict[str, str] = {}  # what belongs into one picture with a result of this kind
MORE, BRANCHES = "more of them", "branches"
BONDED, OTHER = "the bonded structure's", "the other structure's"


def draws(*kinds: str, beside: str = "") -> Callable[[Drawer], Drawer]:
    """Register a function as what draws results of some kinds, and what else may be with them."""

    def register(draw: Drawer) -> Drawer:
        DRAW.update(dict.fromkeys(kinds, draw))
        TOGETHER.update(dict.fromkeys(kinds, beside))
        return draw

    return register


def kind_of(answer: Any) -> str:
    """Return the kind of a result; an empty text if it does not say."""
    attributes = answer.attrs if isinstance(answer, xr.Dataset) else {}
    # older files have only the text of the call
    before = str(attributes.get("call", "")).partition("(")[0]
    return str(attributes.get("question") or attributes.get("analysis") or before)


def required_kind(answer: Any) -> str:
    kind = kind_of(answer)
    if not kind:
        what = type(answer).__name__
        raise InputError(
            f"cannot plot {what}; expected results of one of {', '.join(sorted(DRAW))}"
        )
    return kind
