"""Headless Chromium, driven by selenium."""

import json

from .driven import Driven

WORDS = ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu")


class Chromium(Driven):
    """Its console, and files without a question."""

    def __init__(self, program, driver, downloads):
        from selenium import webdriver

        options = webdriver.ChromeOptions()
        options.binary_location = program
        for word in WORDS:
            options.add_argument(f"--{word}")
        options.add_argument("--autoplay-policy=no-user-gesture-required")
        options.add_argument("--window-size=1300,1400")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = webdriver.ChromeService(driver)
        super().__init__(webdriver.Chrome(options=options, service=service), downloads)
        way = {"behavior": "allow", "downloadPath": str(downloads)}
        self.driver.execute_cdp_cmd("Page.setDownloadBehavior", way)

    def console(self):
        return [json.dumps(line) for line in self.driver.get_log("browser")]
