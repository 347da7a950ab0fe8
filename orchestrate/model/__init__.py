"""Structure, excitation, motor and shaker as a user describes them; checks and outcomes.

=========================  =========================================================================
module                     idea
=========================  =========================================================================
:mod:`.ranges`             names, units, defaults and ranges of parameters, from the variable tables
:mod:`.spelling`           what was probably meant by a name that is not known
:mod:`.arguments`          checks of arguments, for all packages
:mod:`.conversions`        stiffnesses and dampings from frequencies and damping ratios, and back
:mod:`.structure`          a delaminated structure
:mod:`.structure_numbers`  what follows from its parameters: ratios, frequencies, the state at rest
:mod:`.structure_text`     a structure in words
:mod:`.excitation`         the harmonic motion of the box
:mod:`.drive`              a motor with an unbalance, of limited power
:mod:`.shaker`             an electrodynamic shaker with its amplifier
:mod:`.described`          base of what has a section in a TOML file
:mod:`.sections`           such a section, read key by key
:mod:`.toml_files`         TOML files read and written; shipped sets
:mod:`.outcomes`           how a motion was decided
=========================  =========================================================================
"""

from .drive import Drive
from .excitation import Excitation
from .shaker import Shaker
from .structure import Structure
from .structure_numbers import PARAMETERS
from .toml_files import SETS, read, resolve_path, write

__all__ = [
    "PARAMETERS",
    "SETS",
    "Drive",
    "Excitation",
    "Shaker",
    "Structure",
    "read",
    "resolve_path",
    "write",
]
