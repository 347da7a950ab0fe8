"""Structure, excitation, motor and shaker as a user describes them; checks and outcomes.

==================  ===============================================================================
module              idea
==================  ===============================================================================
:mod:`.structure`   two oscillators and their contact
:mod:`.excitation`  the harmonic motion of the box
:mod:`.drive`       a motor with an unbalance, and the box that it shakes
:mod:`.shaker`      an electrodynamic shaker with its amplifier
:mod:`.described`   that these can be read from a file
:mod:`.ranges`      names, units, defaults and ranges, from the FMUs' variable tables
:mod:`.files`       TOML files of these, and the sets that come with the package
:mod:`.sections`    what stands in their sections
:mod:`.plausible`   warnings of numbers that are hardly meant
:mod:`.arguments`   checks of arguments, for all packages
:mod:`.outcomes`    what a motion has been found to be
==================  ===============================================================================
"""

from .drive import Drive
from .excitation import Excitation
from .files import SETS, read, resolve, write
from .shaker import Shaker
from .structure import PARAMETERS, Structure

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
