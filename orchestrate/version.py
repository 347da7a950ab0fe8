"""The package's version: that of the code that runs, also where an old one is installed."""

from fmu_src.version import VERSION

__version__ = VERSION
