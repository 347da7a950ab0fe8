"""The package's version, as installed."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("vibroimpact")
except PackageNotFoundError:  # a checkout that is not installed
    __version__ = "0.0.0"
