"""Explorer: one self-contained HTML page with the FMU's kernel running in the browser.

The sources of the page are in ``page/``: HTML, a style sheet and modern JavaScript modules, one
idea a file.

==================  =============================================
module              idea
==================  =============================================
:mod:`.sweep_data`  the sweep that the page shows, read
:mod:`.branches`    branches of orbits as lines of its diagram
:mod:`.measured`    a measured record beside it
:mod:`.words`       explanations of its terms
:mod:`.tour`        texts and motions of its guided tour
:mod:`.bundle`      its JavaScript modules joined into one script
:mod:`.page`        the page, put together
==================  =============================================
"""
