"""Colours that people tell apart however they see them: Okabe and Ito, Color Universal Design."""

BLACK, GREY = "#000000", "#8c8c8c"
BLUE, RED, GREEN = "#0072b2", "#d55e00", "#009e73"
ORANGE, SKY, PURPLE, YELLOW = "#e69f00", "#56b4e9", "#cc79a7", "#f0e442"
PALETTE = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY, YELLOW)
STRUCTURES = {"bonded": BLUE, "delaminated": RED}
