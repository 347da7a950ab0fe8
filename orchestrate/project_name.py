"""In a wheel this is ``vibroimpact/__init__.py``: the public face under the project's own name."""

import sys

import orchestrate

sys.modules[__name__] = orchestrate
