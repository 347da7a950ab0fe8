"""Headless Chromium with the explorer in it."""

import base64
import json
import time

import numpy as np

COMPLETE = "return document.getElementById('diagram').dataset.complete === 'true'"
PACK = """
const bytes = new Uint8Array(new Float64Array(%s).buffer);
let text = "";
for (const byte of bytes) text += String.fromCharCode(byte);
return btoa(text);
"""


class Browser:
    """What the tests ask of it."""

    def __init__(self, program, driver, downloads):
        from selenium import webdriver

        options = webdriver.ChromeOptions()
        options.binary_location = program
        for word in ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu"):
            options.add_argument(f"--{word}")
        options.add_argument("--autoplay-policy=no-user-gesture-required")
        options.add_argument("--window-size=1300,1400")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = webdriver.ChromeService(driver)
        self.driver = webdriver.Chrome(options=options, service=service)
        self.downloads = downloads
        way = {"behavior": "allow", "downloadPath": str(downloads)}
        self.driver.execute_cdp_cmd("Page.setDownloadBehavior", way)

    def open(self, page, fragment=""):
        self.driver.get("about:blank")
        self.driver.get(page.as_uri() + fragment)
        self.until("return Boolean(window.explorer)")
        self.until(COMPLETE)

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def until(self, script, seconds=60):
        end = time.monotonic() + seconds
        while not (found := self.run(script)):
            assert time.monotonic() < end, f"never: {script}"
            time.sleep(0.03)
        return found

    def numbers(self, expression):
        """An array of the page to the last bit."""
        return np.frombuffer(base64.b64decode(self.run(PACK % expression)))

    def at(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def click(self, name):
        self.at(name).click()

    def mouse(self, name, *places):
        """Press at the first place of an element, as a part of its size, release at the last."""
        from selenium.webdriver import ActionChains

        element = self.at(name)
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        size = element.size
        ways = [
            (round((x - 0.5) * size["width"]), round((y - 0.5) * size["height"])) for x, y in places
        ]
        chain = ActionChains(self.driver, duration=20).move_to_element_with_offset(
            element, *ways[0]
        )
        chain = chain.click_and_hold()
        for way in ways[1:]:
            chain = chain.move_to_element_with_offset(element, *way)
        chain.release().perform()

    def keys(self, *keys):
        from selenium.webdriver import ActionChains

        ActionChains(self.driver).send_keys(*keys).perform()

    def chosen(self, seconds=60):
        """The motion that was asked for has come."""
        self.until("return Boolean(explorer.inspector.found)", seconds)
        return self.run("return explorer.inspector.choice.point.eta")

    def console(self):
        return [json.dumps(line) for line in self.driver.get_log("browser")]

    def download(self, name, seconds=20):
        """A file that the page saves."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = [path for path in self.downloads.glob(name) if path.stat().st_size]
            if found and not list(self.downloads.glob("*.crdownload")):
                return found[0]
            time.sleep(0.05)
        raise AssertionError(f"no {name} among {list(self.downloads.iterdir())}")
