"""The manual's pages of the paper: their numbers are those of the claims beside them."""

import json

import pytest

from orchestrate.paper.claims import read_claims
from tools import paper_page


@pytest.mark.parametrize("page", paper_page.PAGES, ids=lambda page: page.stem)
def test_the_page_is_made_from_the_claims(page):
    found = json.loads(paper_page.CLAIMS.read_text("utf-8"))
    text = page.read_text("utf-8")
    assert paper_page.fill_page(text, found) == text
    other = {**found, "claims": found["claims"][1:]}
    assert paper_page.fill_page(text, other) != text


def test_the_claims_beside_it_are_those_of_the_code():
    rows = json.loads(paper_page.CLAIMS.read_text("utf-8"))["claims"]
    own = [(claim.section, claim.text, claim.printed) for claim in read_claims()]
    assert [(row["section"], row["text"], row["printed"]) for row in rows] == own
    assert all(row["verdict"] != "undecided" for row in rows)
