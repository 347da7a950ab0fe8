"""One self-contained page: the orbit diagram, and behind each of its points the motion, computed in
the browser by the kernel of the FMU.

:mod:`.page` puts it together of the sources in ``page/``: HTML, a style sheet and modern JavaScript
modules, one idea a file, which :mod:`.bundle` joins. :mod:`.shipped` is what a sweep gives to it.
"""
