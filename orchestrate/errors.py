"""A user's mistake, as one line."""


class UserError(Exception):
    """Names the thing, its value and what is allowed; the command line prints it and exits with 2."""


class FmuError(RuntimeError):
    """An FMU refused a call; the text is the FMU's own message."""
