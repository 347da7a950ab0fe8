"""WebKit by its driver, on a screen of its own: Debian's webkit2gtk-driver and xvfb."""

import os
import shutil
import subprocess

from .driven import Driven

FOLDER = "/usr/lib/x86_64-linux-gnu/webkit2gtk-4.1"  # of MiniBrowser, which is in no PATH
SCREEN = ("-screen", "0", "1300x1400x24", "-nolisten", "tcp")
KEEP = "window.wrong = []; addEventListener('error', ({ message }) => wrong.push(message));"


class WebKit(Driven):
    """Its driver says nothing of the console: the page itself keeps what goes wrong."""

    def __init__(self, browser, driver, screen, downloads):
        from selenium import webdriver

        read, write = os.pipe()
        command = [screen, "-displayfd", str(write), *SCREEN]
        self.screen = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as told:
            number = told.readline().strip()
        options = webdriver.WebKitGTKOptions()
        options.binary_location = browser
        options.add_argument("--automation")
        service = webdriver.WebKitGTKService(driver, env={**os.environ, "DISPLAY": f":{number}"})
        super().__init__(webdriver.WebKitGTK(options=options, service=service), downloads)

    def open(self, page, fragment=""):
        super().open(page, fragment)
        self.run(KEEP)

    def console(self):
        return self.run("return window.wrong ?? []")

    def quit(self):
        super().quit()
        self.screen.terminate()
        self.screen.wait(30)


def programs():
    """Browser, driver and screen; None for what is not here."""
    browser = shutil.which("MiniBrowser", path=FOLDER)
    return browser, shutil.which("WebKitWebDriver"), shutil.which("Xvfb")
