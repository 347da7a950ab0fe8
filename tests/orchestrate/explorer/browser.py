"""Headless Chromium with the explorer in it, driven by selenium."""

import base64
import time

import numpy as np

WORDS = ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu")
WORDS += ("autoplay-policy=no-user-gesture-required", "window-size=1300,1400")
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


class Browser:
    """The page in a window: clicks, keys, what it shows, and what it computed to the last bit."""

    leave = ("\ue004",)  # the key with which a field is left, as WebDriver names it

    def __init__(self, program, driver):
        from selenium import webdriver

        options = webdriver.ChromeOptions()
        options.binary_location = program
        for word in WORDS:
            options.add_argument(f"--{word}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = webdriver.ChromeService(driver)
        self.driver = webdriver.Chrome(options=options, service=service)

    def run(self, script, *arguments):
        """What a script returns."""
        return self.driver.execute_script(script, *arguments)

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
        return self.driver.get_log("browser")

    def open(self, page, fragment="", whole=True):
        """Show a page anew, and wait until its whole diagram is there."""
        self.driver.get("about:blank")
        self.driver.get(page.as_uri() + fragment)
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
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        first, *others = self.run(PLACES, name, [list(place) for place in places])
        actions = ActionBuilder(self.driver, duration=20)
        mouse = actions.pointer_action.move_to_location(*first).pointer_down()
        for place in others:
            mouse.move_to_location(*place)
        mouse.pointer_up()
        actions.perform()

    def chosen(self, seconds=60):
        """The motion that was asked for has come."""
        self.until("return Boolean(explorer.inspector.found)", seconds)
        return self.run("return explorer.inspector.choice.point.eta")
