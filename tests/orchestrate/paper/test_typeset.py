"""Plain sentences become HTML with formulas: none is lost, none is left in a program's letters."""

import re

import pytest

from orchestrate.paper.pictures import PARTS
from orchestrate.paper.typeset import FORMULA, match_to_latex, typeset

FORMULAS = {
    "eta": r"\eta",
    "max xi_Rel": r"\max \xi_\mathrm{Rel}",
    "m_1 omega a eta^2": r"m_1 \omega a \eta^2",
    "k_2": "k_2",
    "xi_2": r"\xi_2",
    "nu_i": r"\nu_i",
    "4.1e-04": r"4.1\cdot 10^{-4}",
    "2e+05": r"2\cdot 10^{5}",
    "10^0.5": "10^{0.5}",
    "e^(-D tau)": r"e^{-D\tau}",
    "$a^2 < b$": "a^2 < b",
    "3T": "3T",
}


def shown(text: str) -> str:
    """What a reader sees."""
    return re.sub(r"<[^>]+>", "", typeset(text))


@pytest.mark.parametrize("plain", FORMULAS)
def test_formulas(plain):
    (match,) = FORMULA.finditer(f"so {plain} it is")
    assert match[0] == plain and match_to_latex(match) == FORMULAS[plain]
    assert typeset(f"so {plain} it is").count("<math") == 1


def test_what_is_no_formula_stays():
    text = "T-periodic below beta, a metal & kappas < 3, 1e, and the letter e; at 0.43-0.89"
    assert "<math" not in typeset(text)
    assert typeset(text) == text.replace("&", "&amp;").replace("<", "&lt;")


def test_signs_and_what_a_program_says():
    assert shown("0.038 +- 0.001") == "0.038 ± 0.001"
    assert shown("found: True; nan") == "found: yes; not found"


def test_no_caption_is_left_in_plain_letters():
    for caption in PARTS.values():
        for text in (caption.title, caption.text, caption.method):
            left = re.findall(r"\b(?:eta|kappa|omega|tau|\w+_\w+|<=)\b", shown(text))
            assert left == [], caption.title
