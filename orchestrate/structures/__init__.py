"""What a user describes: a structure, its excitation, a motor with a box; SI or non-dimensional."""

from .drive import Drive
from .excitation import Excitation
from .structure import PARAMETERS, Structure

__all__ = ["PARAMETERS", "Drive", "Excitation", "Structure"]
