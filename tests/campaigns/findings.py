"""How a campaign ends."""

from collections.abc import Iterable, Mapping

SHOWN = 20


def expect_none(findings: Iterable[str], counts: Mapping[str, object]) -> None:
    """Print what a campaign counted (``pytest -rP`` shows it) and fail where it had findings."""
    every = list(findings)
    print(", ".join(f"{name}: {value}" for name, value in sorted(counts.items())))
    assert not every, "\n".join([f"{len(every)} findings", *every[:SHOWN]])
