"""Entry point of ``python -m orchestrate COMMAND``; ``--help`` lists the commands."""

from __future__ import annotations

import os
import signal
import sys
import threading


def run_command_line() -> int:
    """Run the command line; return its exit code, 130 after Ctrl-C."""
    try:
        from .cli import main

        return main()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def main() -> int:
    """Run the command line with its streams open and its signals heard; return its exit code."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:  # in place of a closed standard stream
        os.set_inheritable(number, True)
    os.close(number)
    sys.unraisablehook = resend_interrupt
    if not any(word.startswith("--cluster") for word in sys.argv):
        # xarray loads all of it, half a second, to ask of each array whether it is one of Dask's
        sys.modules.setdefault("dask", None)  # type: ignore[arg-type]
    if signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:  # not ignored
        signal.signal(signal.SIGTERM, raise_terminated)
    return run_command_line()


def raise_terminated(*_: object) -> None:
    from .errors import Terminated

    raise Terminated


def resend_interrupt(lost: sys.UnraisableHookArgs) -> None:
    """Raise Ctrl-C or SIGTERM again where Python has dropped it, in a callback."""
    if not issubclass(lost.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    number = signal.SIGINT if lost.exc_type is KeyboardInterrupt else signal.SIGTERM
    threading.Timer(0.05, send_to_itself, (number,)).start()


def send_to_itself(number: int) -> None:
    """Send this process a signal; on Windows ``os.kill`` would end it at once."""
    if sys.platform == "win32":
        signal.raise_signal(number)
    else:
        os.kill(os.getpid(), number)


if __name__ == "__main__":
    sys.exit(main())
