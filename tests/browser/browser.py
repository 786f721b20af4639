"""Headless Chromium by its DevTools protocol over a pair of pipes: nothing but Python's standard library."""

import base64
import importlib.util
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time


SKIPPED = 77


class BrowserError(Exception):
    pass


def program():
    """Path of Chromium, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def require(*modules):
    """Ends with exit status 77 without Chromium or one of these modules. modules: name of the import and of Debian's package by turns"""
    for module, package in zip(modules[::2], modules[1::2]):
        if importlib.util.find_spec(module) is None:
            print(f"skipped: {package} is not installed")
            sys.exit(SKIPPED)
    if program() is None:
        print("skipped: chromium is not installed")
        sys.exit(SKIPPED)


class Browser:
    """One page. Collects what it prints on the console, its errors, and what it asks of a network."""

    def __init__(self, width=1200, height=900):
        self.profile = tempfile.mkdtemp(prefix="cvtflow-browser-")
        to_read, self.to = os.pipe()
        self.back, back_write = os.pipe()

        def hand_over():
            low, high = os.dup(to_read), os.dup(back_write)
            os.dup2(low, 3)
            os.dup2(high, 4)

        self.process = subprocess.Popen(
            [program(), "--headless=new", "--no-sandbox", "--remote-debugging-pipe", f"--user-data-dir={self.profile}",
             "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-extensions",
             "--disable-background-networking", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=hand_over, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(back_write)
        self.rest = b""
        self.number = 0
        self.events, self.complaints, self.requests = [], [], []
        targets = self.call("Target.getTargets", session=None)["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self.session = self.call("Target.attachToTarget", {"targetId": page["targetId"], "flatten": True}, None)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.resize(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        self.process.kill()
        self.process.wait()
        os.close(self.to)
        os.close(self.back)
        shutil.rmtree(self.profile, ignore_errors=True)

    def resize(self, width, height, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})

    def message(self, until):
        """The next message, or None if none comes until then."""
        while b"\0" not in self.rest:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.back], [], [], left)[0]:
                return None
            more = os.read(self.back, 1 << 20)
            if not more:
                raise BrowserError("the browser has gone")
            self.rest += more
        text, self.rest = self.rest.split(b"\0", 1)
        message = json.loads(text)
        self.note(message)
        return message

    def note(self, message):
        name, what = message.get("method", ""), message.get("params", {})
        self.events.append(name)
        if name == "Runtime.exceptionThrown":
            self.complaints.append(what["exceptionDetails"].get("exception", {}).get("description", str(what)))
        if name == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.complaints.append(str([argument.get("value") for argument in what["args"]]))
        if name == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.complaints.append(what["entry"]["text"])
        if name == "Network.requestWillBeSent" and not what["request"]["url"].startswith(("file:", "data:", "blob:", "about:")):
            self.requests.append(what["request"]["url"])

    def call(self, method, parameters=None, session="own", seconds=60):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters or {}}
        if session == "own":
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + seconds
        while (answer := self.message(until)) is not None:
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise BrowserError(f"{method}: {answer['error']['message']}")
                return answer["result"]
        raise BrowserError(f"{method}: no answer within {seconds} s")

    def load(self, act, seconds=60):
        """Acts, and waits until that has loaded a page."""
        self.events.clear()
        act()
        until = time.monotonic() + seconds
        while "Page.loadEventFired" not in self.events:
            if self.message(until) is None:
                raise BrowserError(f"the page did not load within {seconds} s")

    def open(self, path):
        self.load(lambda: self.call("Page.navigate", {"url": "file://" + os.path.abspath(path)}))

    def value(self, expression):
        """What an expression of JavaScript is, a promise awaited."""
        result = self.call("Runtime.evaluate", {"expression": expression, "returnByValue": True, "awaitPromise": True})
        if "exceptionDetails" in result:
            raise BrowserError(result["exceptionDetails"].get("exception", {}).get("description", expression))
        return result["result"].get("value")

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1})

    def key(self, name):
        text = {"text": name} if len(name) == 1 else {}
        self.call("Input.dispatchKeyEvent", {"type": "keyDown", "key": name, **text})
        self.call("Input.dispatchKeyEvent", {"type": "keyUp", "key": name})

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot")["data"]))
