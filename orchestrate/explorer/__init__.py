"""Explorer: one self-contained HTML page with the FMU's kernel running in the browser.

:mod:`.page` puts it together of the sources in ``page/``: HTML, a style sheet and modern JavaScript
modules, one idea a file, which :mod:`.bundle` joins. :mod:`.sweep_data` reads the sweep that it
shows.
"""
