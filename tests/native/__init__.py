"""The native FMUs as importers in C meet them: any calls, event mode, bits on every platform."""
