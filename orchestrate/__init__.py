"""What is done with the FMUs: frequency sweeps and their pictures, all computed by FMPy through the exported FMU."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("vibroimpact")
except PackageNotFoundError:  # a checkout that is not installed
    __version__ = "0.0.0"
