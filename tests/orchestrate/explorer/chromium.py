"""Headless Chromium, driven by selenium."""

import json

from .browser import Browser

WORDS = ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu")


class Chromium(Browser):
    """With ``driver`` for what only Chromium can be asked."""

    def __init__(self, program, driver, downloads):
        from selenium import webdriver

        super().__init__(downloads)
        options = webdriver.ChromeOptions()
        options.binary_location = program
        for word in WORDS:
            options.add_argument(f"--{word}")
        options.add_argument("--autoplay-policy=no-user-gesture-required")
        options.add_argument("--window-size=1300,1400")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        service = webdriver.ChromeService(driver)
        self.driver = webdriver.Chrome(options=options, service=service)
        way = {"behavior": "allow", "downloadPath": str(downloads)}
        self.driver.execute_cdp_cmd("Page.setDownloadBehavior", way)

    def navigate(self, url):
        self.driver.get(url)

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def drag(self, places):
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        actions = ActionBuilder(self.driver, duration=20)
        mouse = actions.pointer_action
        mouse.move_to_location(*places[0]).pointer_down()
        for place in places[1:]:
            mouse.move_to_location(*place)
        mouse.pointer_up()
        actions.perform()

    def keys(self, *keys, held=None):
        from selenium.webdriver import ActionChains

        chain = ActionChains(self.driver)
        if held:
            chain.key_down(held)
        chain.send_keys(*keys)
        if held:
            chain.key_up(held)
        chain.perform()

    def console(self):
        return [json.dumps(line) for line in self.driver.get_log("browser")]

    def quit(self):
        self.driver.quit()
