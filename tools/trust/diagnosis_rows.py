"""Column names of the rows that the campaign on diagnoses keeps of each beam."""

DELAMINATED, NO_OPENING = "delaminated", "no opening seen"
NOT_DESCRIBED, UNDECIDED = "not described", "undecided"
REFUSED, FAILED = "refused", "failed"
USUAL, WIDE = (0.01, 0.05), (0.001, 0.1)  # noise: of the targets, and of all curves
FITTED = ("f1", "f2", "zeta1", "zeta2", "e")  # of which the stated errors are judged
WITHIN = 1.96  # standard errors: half of an interval of 95 %
COLUMNS = (
    *("kind", "delaminated", "opened", "touched", "gap", "noise", "level", "sensors"),
    *("excitation", "size", "clearance", "change", "order ratio", "kurtosis"),
    *("verdict", "ratio", "f1 error", "f2 error"),
    *(f"{name} deviation" for name in FITTED),
    *("seconds", "wrong"),
)
