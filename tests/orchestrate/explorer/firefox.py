"""Headless Firefox by WebDriver BiDi, which it speaks without a driver program."""

import json
import re
import subprocess

START = ("--headless", "--no-remote", "--new-instance", "--remote-debugging-port", "0")


class Firefox:
    """As much of it as a page needs to be opened and asked."""

    def __init__(self, program, profile):
        command = [program, *START, "--profile", str(profile)]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.number, self.errors = 0, []
        place = next(filter(None, (re.search(r"ws://\S+", line) for line in self.process.stderr)))
        from websocket import create_connection

        self.socket = create_connection(f"{place[0]}/session", timeout=60, suppress_origin=True)
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["log.entryAdded"])
        tree = self.ask("browsingContext.getTree")
        self.context = tree["contexts"][0]["context"]

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

    def open(self, page, fragment=""):
        url = page.as_uri() + fragment
        self.ask("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def run(self, expression):
        """The value of an expression, through JSON."""
        found = self.ask(
            "script.evaluate",
            expression=f"(async () => JSON.stringify(await ({expression})))()",
            target={"context": self.context},
            awaitPromise=True,
        )
        assert found["type"] == "success", found
        return json.loads(found["result"]["value"])

    def quit(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait(30)
