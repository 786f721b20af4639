#!/usr/bin/python3
"""The built pages in a real browser: every page of the sidebar opens, a click leads to it, and the search finds pages.

    tests/browser/site_test.py HTML_DIR

HTML_DIR is what tools/docs has built. Exit status 77: Chromium is not installed.
"""

import os
import sys
import unittest

from browser import Browser, require

require()

HTML = os.path.abspath(sys.argv[1])
LINKS = "[...document.querySelectorAll('.wy-menu-vertical li.toctree-l1 > a')]"


class Site(unittest.TestCase):
    def open(self, page):
        browser.complaints.clear()
        browser.requests.clear()
        browser.open(os.path.join(HTML, page))
        browser.value("1")
        self.assertEqual(browser.complaints, [], page)
        self.assertEqual(browser.requests, [], page)

    def test_every_page_opens_without_an_error_or_a_request(self):
        self.open("docs/index.html")
        targets = browser.value(LINKS + ".map((a) => a.href.split('#')[0])")
        self.assertGreater(len(targets), 20)
        for target in targets:
            self.open(target.removeprefix("file://"))
            self.assertTrue(browser.value("document.querySelector('h1').textContent.trim()"), target)

    def test_a_click_leads_to_the_page_and_marks_it(self):
        self.open("docs/index.html")
        box = browser.value(f"""(() => {{ const b = {LINKS}[2].getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2]; }})()""")
        before = browser.value("location.href")
        browser.load(lambda: browser.click(*box))
        self.assertNotEqual(browser.value("location.href"), before)
        self.assertEqual(browser.value("document.querySelectorAll('li.toctree-l1.current').length"), 1)

    def test_the_search_finds_the_reference_of_a_key_first(self):
        self.open("search.html?q=load.torque")
        self.assertIn("docs/scene_reference.html#load", browser.value("""new Promise((done) => { const first = () =>
            document.querySelector('#search-results a'), wait = () => first() ? done(first().href) : setTimeout(wait, 50); wait();
            setTimeout(() => done('nothing found'), 10000); })"""))


if __name__ == "__main__":
    with Browser() as browser:
        unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
