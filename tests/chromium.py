"""Start headless Chromium by selenium, for tests and campaigns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

WORDS = ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu")


def start_chromium(program: str, driver: str, downloads: Path) -> Any:
    """Start Chromium without a window; return selenium's driver, to be quit by the caller."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = program
    for word in WORDS:
        options.add_argument(f"--{word}")
    options.add_argument("--autoplay-policy=no-user-gesture-required")
    options.add_argument("--window-size=1300,1400")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    saving = {"behavior": "allow", "downloadPath": str(downloads)}  # without a question
    browser.execute_cdp_cmd("Page.setDownloadBehavior", saving)
    return browser
