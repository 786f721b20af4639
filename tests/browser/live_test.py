#!/usr/bin/python3
"""The live page in a real browser: a slider is moved, and what the page shows is what the program gives. Status 77: packages are missing.

    tests/browser/live_test.py CVTFLOW PAGE.html [FOLDER]    FOLDER: pictures of the page go there
"""

import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

from browser import Browser, require

require("h5py", "python3-h5py")
import h5py

CVTFLOW, PAGE = (os.path.abspath(path) for path in sys.argv[1:3])
PICTURES = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else None
UNTIL = 0.002
LINK = f"#scene=baseline&detail=rigid&start.settling_time=1+ms&start.ramp_time=0.5+ms&until={UNTIL}"


def wait(browser, condition, seconds=120):
    end = time.monotonic() + seconds
    while not browser.value(condition):
        if time.monotonic() > end:
            raise AssertionError(f"not within {seconds} s: {condition}; {browser.value('document.getElementById(`fault`).textContent')}")
        time.sleep(0.1)


def restart(browser):
    frames = browser.value("live.frames")
    browser.value("document.getElementById('restart').click()")
    wait(browser, f"live.frames > {frames}")


def reload(browser):
    """Opens the link of the page, which contains the settings."""
    browser.load(lambda: browser.call("Page.reload"), 120)
    wait(browser, "window.live && live.frames > 0")


def by_program(toml):
    """Hash and ratio at the same time by the program, from the scene that the page gave; check accepts it."""
    with tempfile.TemporaryDirectory() as folder:
        path, record = os.path.join(folder, "scene.toml"), os.path.join(folder, "run.h5")
        with open(path, "w") as file:
            file.write(toml)
        subprocess.run([CVTFLOW, "check", path], check=True, capture_output=True)
        run = subprocess.run([CVTFLOW, "run", path, "--until", f"{UNTIL} s", "-o", record], check=True, capture_output=True, text=True)
        with h5py.File(record) as file:
            ratio = file["channels/ratio"][-1]
        return re.search(r"state hash\s+([0-9a-f]{16})", run.stdout)[1], float(ratio)


class LivePage(unittest.TestCase):
    def ended(self, browser):
        wait(browser, f"live.frame && !live.frame.running && live.frame.time >= {UNTIL}")
        return browser.value("live.frame.hash")

    def follow(self, width, again):
        with Browser(width=width, height=900) as browser:
            browser.open(PAGE + LINK)
            before = self.ended(browser)
            self.assertGreater(browser.value("live.firstPicture"), 0)
            print(f"{width} px: first picture after {browser.value('live.firstPicture'):.2f} s, pace"
                  f" {browser.value('document.getElementById(`pace`).textContent')}, memory of the simulation"
                  f" {browser.value('live.frame.memory') / 1e6:.0f} MB")
            x, y = browser.value("(() => { const slider = document.getElementById('input-load.torque');"
                                 " slider.scrollIntoView({block: 'center'}); const box = slider.getBoundingClientRect();"
                                 " return [box.left + 0.8 * box.width, box.top + 0.5 * box.height]; })()")
            browser.click(x, y)
            torque = browser.value("Number(document.getElementById('input-load.torque').value)")
            self.assertTrue(140 < torque < 300, torque)
            self.assertIn(f"load.torque={browser.value('live.settings.keys[`load.torque`]')}", browser.value("location.hash"))
            again(browser)
            after = self.ended(browser)
            self.assertNotEqual(before, after)
            browser.value("document.getElementById('download').click()")
            wait(browser, "live.toml !== undefined")
            toml = browser.value("live.toml")
            expected, ratio = by_program(toml)
            self.assertEqual(after, expected)
            self.assertEqual(browser.value("document.getElementById('hash').textContent"), expected)
            self.assertEqual(browser.value("live.frame.numbers.ratio"), ratio)
            shown = browser.value("document.querySelector('#strips figcaption').textContent").split()
            self.assertEqual(shown, ["Ratio", f"{float(f'{ratio:.4g}'):g}"])
            self.assertLessEqual(browser.value("document.documentElement.scrollWidth"), width)
            self.assertIn("closes", browser.value("document.getElementById('energy').textContent"))
            if PICTURES:
                browser.value("window.scrollTo(0, 0)")
                browser.screenshot(os.path.join(PICTURES, f"live_{width}.png"))
            self.assertEqual(browser.complaints, [])
            self.assertEqual(browser.requests, [])

    def test_gives_the_programs_numbers_on_a_telephone(self):
        self.follow(390, restart)

    def test_gives_the_programs_numbers_on_a_desk(self):
        self.follow(1280, reload)

    def test_reports_a_key_that_no_scene_has(self):
        with Browser() as browser:
            browser.open(PAGE + "#scene=tiny&start.nonsense=1")
            wait(browser, "document.getElementById('fault').textContent.includes('nonsense')")

    def test_pauses_and_continues(self):
        with Browser() as browser:
            browser.open(PAGE + "#scene=baseline&start.settling_time=0")
            wait(browser, "live.frames > 3")
            browser.value("document.getElementById('play').click()")
            wait(browser, "document.getElementById('play').textContent === 'Run'")
            before, still = None, browser.value("live.frame.time")
            for _ in range(20):  # a piece that has begun ends, on a busy machine after seconds
                if before == still:
                    break
                time.sleep(0.5)
                before, still = still, browser.value("live.frame.time")
            time.sleep(0.5)
            self.assertEqual(browser.value("live.frame.time"), still)
            browser.value("document.getElementById('play').click()")
            wait(browser, f"live.frame.time > {still}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
