"""Headless Chromium with the explorer in it, driven by selenium."""

import base64
import json
import time

import numpy as np

from tests.chromium import start_chromium

COMPLETE = "return document.getElementById('diagram').dataset.complete === 'true'"
PACK = """
const bytes = new Uint8Array(new Float64Array(%s).buffer);
let text = "";
for (const byte of bytes) text += String.fromCharCode(byte);
return btoa(text);
"""
PLACES = """
const element = document.getElementById(arguments[0]);
element.scrollIntoView({ block: "center", behavior: "instant" });
const { left, top, width, height } = element.getBoundingClientRect();
return arguments[1].map(([x, y]) => [Math.round(left + x * width), Math.round(top + y * height)]);
"""
ENTER, TAB = "\ue007", "\ue004"  # as WebDriver names keys
UNFINISHED = ".crdownload"


class Browser:
    """The page in a window: clicks, keys, what it shows, and what it computed to the last bit."""

    leave = (TAB,)  # keys with which a field is left

    def __init__(self, program, driver, downloads):
        self.driver, self.downloads = start_chromium(program, driver, downloads), downloads

    def navigate(self, url):
        self.driver.get(url)

    def run(self, script, *arguments):
        """What a script returns."""
        return self.driver.execute_script(script, *arguments)

    def drag(self, places):
        """Press the mouse at the first place of the window, in pixels, release it at the last."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        actions = ActionBuilder(self.driver, duration=20)
        mouse = actions.pointer_action
        mouse.move_to_location(*places[0]).pointer_down()
        for place in places[1:]:
            mouse.move_to_location(*place)
        mouse.pointer_up()
        actions.perform()

    def keys(self, *keys, held=None):
        """Type, while another key is held."""
        from selenium.webdriver import ActionChains

        chain = ActionChains(self.driver)
        if held:
            chain.key_down(held)
        chain.send_keys(*keys)
        if held:
            chain.key_up(held)
        chain.perform()

    def console(self):
        """What went wrong since this was asked last."""
        return [json.dumps(line) for line in self.driver.get_log("browser")]

    def open(self, page, fragment="", whole=True):
        """Show a page anew, and wait until its whole diagram is there."""
        self.navigate("about:blank")
        self.navigate(page.as_uri() + fragment)
        self.until("return Boolean(window.explorer)")
        if whole:
            self.until(COMPLETE)

    def until(self, script, seconds=60):
        end = time.monotonic() + seconds
        while not (found := self.run(script)):
            assert time.monotonic() < end, f"never: {script}"
            time.sleep(0.03)
        return found

    def numbers(self, expression):
        """An array of the page to the last bit."""
        return np.frombuffer(base64.b64decode(self.run(PACK % expression)))

    def get(self, name, attribute):
        """An attribute or property of an element."""
        script = "const at = document.getElementById(arguments[0]); const name = arguments[1];"
        return self.run(f"{script} return at.getAttribute(name) ?? at[name]", name, attribute)

    def text(self, name):
        return self.get(name, "textContent")

    def click(self, name):
        self.mouse(name, (0.5, 0.5))

    def mouse(self, name, *places):
        """Press at the first place of an element, as a part of its size, release at the last."""
        self.drag(self.run(PLACES, name, [list(place) for place in places]))

    def chosen(self, seconds=60):
        """The motion that was asked for has come."""
        self.until("return Boolean(explorer.inspector.found)", seconds)
        return self.run("return explorer.inspector.choice.point.eta")

    def download(self, name, seconds=20):
        """A file that the page saves."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            known = list(self.downloads.iterdir())
            found = [path for path in self.downloads.glob(name) if path.stat().st_size]
            if found and not any(path.suffix == UNFINISHED for path in known):
                return found[0]
            time.sleep(0.05)
        raise AssertionError(f"no {name} among {list(self.downloads.iterdir())}")
