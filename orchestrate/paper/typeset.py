r"""Convert formulas in plain sentences to MathML, which browsers show without a script.

What the paper's letters are called in plain text, in claims and captions, becomes a
formula: ``xi_Rel``, ``eta``, ``e = 0.7``, ``1e-4``; so does what stands between dollars, in LaTeX.
"""

from __future__ import annotations

import functools
import re

from docutils.utils.math.latex2mathml import tex2mathml
from markupsafe import Markup, escape

from .claims import replace_symbols_by_words

LETTERS = ("eta", "kappa", "lambda", "omega", "gamma", "tau", "mu", "nu", "xi", "pi")
WORDS = {  # regular expressions and what they become, the longest first
    r"\$(?P<latex>[^$]+)\$": r"\g<latex>",
    r"e\^\(-D tau\)": r"e^{-D\\tau}",
    r"\bm_1 omega a\s+eta\^2": r"m_1 \\omega a \\eta^2",
    r"\ba eta\^2": r"a \\eta^2",
    r"\(1\+e\) mu/\(1\+mu\)": r"(1+e)\\mu/(1+\\mu)",
    r"\bmax xi_Rel\b": r"\\max \\xi_\\mathrm{Rel}",
    r"\bxi_Rel\b": r"\\xi_\\mathrm{Rel}",
    rf"\b(?P<greek>{'|'.join(LETTERS)})_(?P<of>[12i])\b": r"\\\g<greek>_\g<of>",
    r"\b(?P<mass>[mkdxD])_(?P<index>[12i])\b": r"\g<mass>_\g<index>",
    rf"\b(?P<power>{'|'.join(LETTERS)})\^2": r"\\\g<power>^2",
    rf"\b(?P<letter>{'|'.join(LETTERS)})\b": r"\\\g<letter>",
    r"(?P<digits>\d+(?:\.\d+)?)e(?P<minus>-?)\+?0*(?P<ten>\d+)\b": (
        r"\g<digits>\\cdot 10^{\g<minus>\g<ten>}"
    ),
    r"\b10\^(?P<exponent>-?[\d.]+)": r"10^{\g<exponent>}",
    r"\((?P<pair>e, D)\)": r"(\g<pair>)",
    r"\b(?P<name>[eDT])(?= [=<>])": r"\g<name>",
    r"\b(?P<periods>[\dn]?T)\b(?!-)": r"\g<periods>",
}
FORMULA = re.compile("|".join(f"(?P<word{i}>{word})" for i, word in enumerate(WORDS)))
LATEX = tuple(WORDS.values())


@functools.cache
def mathml(latex: str) -> Markup:
    """Convert a LaTeX formula to inline MathML, as HTML that needs no escaping."""
    return Markup(tex2mathml(latex).replace("\n", ""))


def typeset(text: str) -> Markup:
    parts, end, text = [], 0, replace_symbols_by_words(text)
    for match in FORMULA.finditer(text):
        latex = match.expand(LATEX[int(str(match.lastgroup).removeprefix("word"))])
        parts += [escape(text[end : match.start()]), mathml(latex)]
        end = match.end()
    return Markup("").join([*parts, escape(text[end:])])
