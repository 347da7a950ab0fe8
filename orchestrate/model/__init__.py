"""Structure, excitation, motor and shaker as a user describes them; checks and outcomes."""

from .drive import Drive
from .excitation import Excitation
from .files import SETS, read, resolve, write
from .shaker import Shaker
from .structure import Structure
from .structure_numbers import PARAMETERS

__all__ = [
    "PARAMETERS",
    "SETS",
    "Drive",
    "Excitation",
    "Shaker",
    "Structure",
    "read",
    "resolve",
    "write",
]
