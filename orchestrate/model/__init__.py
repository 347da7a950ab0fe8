"""Structure, excitation, motor and shaker as a user describes them; checks and outcomes."""

from .drive import Drive
from .excitation import Excitation
from .shaker import Shaker
from .structure import Structure
from .structure_numbers import PARAMETERS
from .toml_files import SETS, read, resolve, write

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
