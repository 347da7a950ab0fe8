"""Colours, lines and marks that stand for one thing in every picture.

People tell the colours apart however they see them: Okabe and Ito, Color Universal Design.
"""

BLACK, GREY = "#000000", "#8c8c8c"
BLUE, RED, GREEN = "#0072b2", "#d55e00", "#009e73"
ORANGE, SKY, PURPLE, YELLOW = "#e69f00", "#56b4e9", "#cc79a7", "#f0e442"
PALETTE = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW)
BESIDES_RED = tuple(colour for colour in PALETTE if colour != RED)  # where red has a meaning
STRUCTURES = {"bonded": BLUE, "delaminated": RED}
DIRECTIONS = {"up": BLUE, "down": RED}
DIRECTION_STYLES = {"up": "-", "down": "--"}
BIFURCATION_MARKS = {
    **{"fold": "<", "period doubling": "s", "period halving": "d", "Neimark-Sacker": "o"},
    **{"grazing of an impact": "v", "grazing of a flight": "^", "earlier release": "D"},
    **{"loss of permanent contact": "X", "begin of permanent contact": "P"},
}
