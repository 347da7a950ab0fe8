"""Headless Chromium, driven by selenium."""

import json

from tools.chromium import start_chromium

from .driven import Driven


class Chromium(Driven):
    """Its console, and files without a question."""

    def __init__(self, program, driver, downloads):
        super().__init__(start_chromium(program, driver, downloads), downloads)

    def console(self):
        return [json.dumps(line) for line in self.driver.get_log("browser")]
