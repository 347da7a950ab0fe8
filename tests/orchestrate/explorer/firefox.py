"""Headless Firefox by WebDriver BiDi, which it speaks without a driver program."""

import json
import re
import subprocess
import time

from .browser import ENTER, TAB, Browser

START = ("--headless", "--no-remote", "--new-instance", "--remote-debugging-port", "0")
SIZE = {"width": 1300, "height": 1270}
TRIES, PATIENCE = 4, 15.0  # s
SAVED = "text/csv,image/png,image/svg+xml"


class Firefox(Browser):
    """A process of its own, with a profile of its own.

    Headless it has no focus, and a field that is left then has not changed: Enter says so.
    """

    leave = (ENTER, TAB)

    def __init__(self, program, profile, downloads):
        from websocket import create_connection

        super().__init__(downloads)
        (profile / "user.js").write_text(preferences(downloads))
        told = profile / "stderr.txt"
        with told.open("w") as file:
            command = [program, *START, "--profile", str(profile)]
            self.process = subprocess.Popen(command, stderr=file, text=True)
        self.number, self.errors = 0, []
        place = address(told)
        self.socket = create_connection(f"{place}/session", timeout=60, suppress_origin=True)
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["log.entryAdded"])
        tree = self.ask("browsingContext.getTree")
        self.context = tree["contexts"][0]["context"]
        self.ask("browsingContext.setViewport", context=self.context, viewport=SIZE)

    def ask(self, method, **parameters):
        """A command's result."""
        self.number += 1
        asked = {"id": self.number, "method": method, "params": parameters}
        self.socket.send(json.dumps(asked))
        while True:
            told = json.loads(self.socket.recv())
            if told.get("method") == "log.entryAdded" and told["params"]["level"] == "error":
                self.errors.append(told["params"]["text"])
            if told.get("id") == self.number:
                assert told["type"] == "success", told
                return told["result"]

    def navigate(self, url):
        """Load a page; again where a navigation gets lost, of which Firefox tells nothing."""
        for _ in range(TRIES):
            self.ask("browsingContext.navigate", context=self.context, url=url, wait="none")
            end = time.monotonic() + PATIENCE
            while time.monotonic() < end:
                if self.is_at(url.partition("#")[0]):
                    return
                time.sleep(0.05)
        raise AssertionError(f"never loaded: {url}")

    def is_at(self, url):
        """Whether a page is there as a whole; while one process hands over to another it is not."""
        try:
            place, state = self.run("return [location.href, document.readyState]")
        except AssertionError:
            return False
        return place.partition("#")[0] == url and state == "complete"

    def run(self, script, *arguments):
        call = f"(function () {{ {script}\n}}).apply(null, {json.dumps(arguments)})"
        found = self.ask(
            "script.evaluate",
            expression=f"JSON.stringify({call}) ?? 'null'",
            target={"context": self.context},
            awaitPromise=False,
            userActivation=False,
        )
        assert found["type"] == "success", found
        return json.loads(found["result"]["value"])

    def act(self, source, actions):
        """What a mouse or a keyboard does."""
        done = [{**source, "id": source["type"], "actions": actions}]
        self.ask("input.performActions", context=self.context, actions=done)

    def drag(self, places):
        moves = [{"type": "pointerMove", "x": x, "y": y, "duration": 20} for x, y in places]
        down, up = ({"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp"))
        self.act({"type": "pointer"}, [moves[0], down, *moves[1:], up])

    def keys(self, *keys, held=None):
        typed = [
            {"type": kind, "value": key}
            for text in keys
            for key in text
            for kind in ("keyDown", "keyUp")
        ]
        around = [[{"type": kind, "value": held}] if held else [] for kind in ("keyDown", "keyUp")]
        self.act({"type": "key"}, [*around[0], *typed, *around[1]])

    def console(self):
        self.run("")  # errors told before its answer have come then
        found, self.errors = self.errors, []
        return found

    def quit(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait(30)


def preferences(downloads):
    """Files are saved without asking where."""
    chosen = {
        "browser.download.folderList": 2,
        "browser.download.dir": str(downloads),
        "browser.helperApps.neverAsk.saveToDisk": SAVED,
        "browser.download.always_ask_before_handling_new_types": False,
    }
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(chosen[name])});" for name in chosen]
    return "\n".join(lines)


def address(told, seconds=60):
    """Where the browser listens, once it has told so."""
    end = time.monotonic() + seconds
    while not (found := re.search(r"ws://\S+", told.read_text())):
        assert time.monotonic() < end, told.read_text()
        time.sleep(0.05)
    return found[0]
