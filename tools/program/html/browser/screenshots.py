"""Pictures of a report: screenshots.py REPORT.html DIR"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../../tests/browser"))
from browser import Browser

page, folder = sys.argv[1:]
with Browser(1150, 900) as browser:
    browser.open(page)
    browser.screenshot(os.path.join(folder, "report.png"))
    browser.value("chain.show(chain.t.length / 2); chain.pick(10); document.getElementById('running').scrollIntoView()")
    browser.screenshot(os.path.join(folder, "chain.png"))
