#!/usr/bin/python3
"""The built pages in a real browser: every page of the sidebar opens, formulas fit a phone, the search finds pages.

    tests/browser/site_test.py HTML_DIR SOURCE_DIR

HTML_DIR is what tools/docs has built. Exit status 77: Chromium is not installed.
"""

import os
import re
import sys
import time
import unittest

from browser import Browser, require

require()

HTML, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
LINKS = "[...document.querySelectorAll('.wy-menu-vertical li.toctree-l1 > a')]"


class Site(unittest.TestCase):
    def open(self, page):
        browser.complaints.clear()
        browser.requests.clear()
        browser.open(os.path.join(HTML, page))
        browser.value("1")
        self.assertEqual(browser.complaints, [], page)
        self.assertEqual(browser.requests, [], page)

    def pages(self):
        self.open("docs/index.html")
        targets = browser.value(LINKS + ".map((a) => a.href.split('#')[0])")
        return [os.path.relpath(target.removeprefix("file://"), HTML) for target in targets]

    def test_the_sidebar_has_the_order_of_the_table_of_contents(self):
        with open(os.path.join(SOURCE, "docs/site/contents.rst")) as file:
            named = [name.lstrip("/") if name.startswith("/") else "docs/site/" + name
                     for name in re.findall(r"^   (/?[\w/]+)$", file.read(), re.MULTILINE)]
        listed = [page.removesuffix(".html") for page in self.pages()]
        self.assertGreater(len(named), 20)
        self.assertEqual(list(dict.fromkeys(page for page in listed if page in named)), named)

    def test_every_page_opens_without_an_error_or_a_request(self):
        pages = self.pages()
        self.assertGreater(len(pages), 30)
        for page in pages:
            self.open(page)
            self.assertTrue(browser.value("document.querySelector('h1').textContent.trim()"), page)

    def test_formulas_have_their_fonts_and_scroll_on_a_phone(self):
        browser.resize(390, 800)
        self.addCleanup(browser.resize, 1200, 900)
        for page, formulas in (("model/EQUATIONS.html", 500), ("docs/validation.html", 20)):
            self.open(page)
            self.assertGreater(browser.value("document.querySelectorAll('.katex').length"), formulas, page)
            fonts = browser.value("document.fonts.ready.then((fonts) => [...fonts].filter((f) => f.status == 'loaded').map((f) => f.family))")
            self.assertTrue({"KaTeX_Main", "KaTeX_Math"} <= set(fonts), fonts)
            self.assertLessEqual(browser.value("document.documentElement.scrollWidth - innerWidth"), 0, page)
            scrolls = browser.value("""[...document.querySelectorAll('.katex-display')].map((e) => [e.scrollWidth > e.clientWidth,
                (e.scrollLeft = 1e6, e.scrollLeft > 0)])""")
            self.assertTrue(any(wide for wide, _ in scrolls), page)
            self.assertTrue(all(wide == moved for wide, moved in scrolls), page)

    def test_a_click_leads_to_the_page_and_marks_it(self):
        self.open("docs/index.html")
        box = browser.value(f"""(() => {{ const b = {LINKS}[2].getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2]; }})()""")
        before = browser.value("location.href")
        browser.events.clear()
        browser.click(*box)
        until = time.monotonic() + 60
        while "Page.loadEventFired" not in browser.events:
            self.assertIsNotNone(browser.message(until), "the click did not load a page within 60 s")
        self.assertNotEqual(browser.value("location.href"), before)
        self.assertEqual(browser.value("document.querySelectorAll('li.toctree-l1.current').length"), 1)

    def test_the_search_finds_pages(self):
        self.open("search.html?q=slip")
        found = "document.querySelectorAll('#search-results li').length"
        self.assertGreater(browser.value(f"""new Promise((done) => {{ const wait = () => {found} > 5 ? done({found}) : setTimeout(wait, 50);
            wait(); setTimeout(() => done({found}), 10000); }})"""), 5)


if __name__ == "__main__":
    with Browser() as browser:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
