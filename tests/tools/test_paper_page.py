"""The manual's page of the paper: its numbers are those of the claims beside it."""

from __future__ import annotations

import json

from orchestrate.paper.claims import CLAIMS
from tools import paper_page


def test_the_page_is_made_from_the_claims():
    found = json.loads(paper_page.CLAIMS.read_text("utf-8"))
    text = paper_page.PAGE.read_text("utf-8")
    assert paper_page.page(text, found) == text


def test_the_claims_beside_it_are_those_of_the_code():
    rows = json.loads(paper_page.CLAIMS.read_text("utf-8"))["claims"]
    own = [(claim.section, claim.text, claim.printed) for claim in CLAIMS]
    assert [(row["section"], row["text"], row["printed"]) for row in rows] == own
    assert all(row["verdict"] != "undecided" for row in rows)
