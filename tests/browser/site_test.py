#!/usr/bin/python3
"""The built pages in a real browser: every page of the sidebar opens, formulas fit a phone, the search finds pages and shows where.

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
PLACE = """(() => {
    const place = (found) => { const box = document.querySelector(found).getBoundingClientRect(); return [box.top, box.bottom]; };
    const field = document.querySelector('.wy-side-nav-search input'), box = field.getBoundingClientRect();
    return {scrolled: document.querySelector('.wy-side-scroll').scrollTop, head: place('.wy-side-nav-search')[1],
            entry: place('.wy-menu-vertical a.current'), height: innerHeight,
            open: document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2) === field};
})()"""


def groups_of_contents():
    """Caption and pages of every group of the sidebar, as its source lists them."""
    with open(os.path.join(SOURCE, "docs/site/contents.rst")) as file:
        parts = re.split(r"^   :caption: (.*)$", file.read(), flags=re.MULTILINE)
    pages = [re.findall(r"^   (/?[\w/]+)$", text, re.MULTILINE) for text in parts[2::2]]
    return {caption: [name.removeprefix("/") if name.startswith("/") else "docs/site/" + name for name in names]
            for caption, names in zip(parts[1::2], pages)}


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

    def test_tables_fit_a_screen_and_options_keep_their_hyphens(self):
        browser.resize(1280, 900)
        self.addCleanup(browser.resize, 1200, 900)
        for page in ("docs/scene_reference.html", "docs/channel_reference.html", "docs/index.html"):
            self.open(page)
            self.assertEqual(browser.value("""[...document.querySelectorAll(".wy-table-responsive")].filter(
                (box) => box.scrollWidth > box.clientWidth + 1).length"""), 0, page)
        self.open("docs/commands.html" if os.path.exists(os.path.join(HTML, "docs/commands.html")) else "docs/index.html")
        self.assertNotIn("\u2013scene", browser.value("document.body.textContent"))

    def test_a_click_leads_to_the_page_and_marks_it(self):
        self.open("docs/index.html")
        box = browser.value(f"""(() => {{ const b = {LINKS}[2].getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2]; }})()""")
        before = browser.value("location.href")
        browser.load(lambda: browser.click(*box))
        self.assertNotEqual(browser.value("location.href"), before)
        self.assertEqual(browser.value("document.querySelectorAll('li.toctree-l1.current').length"), 1)

    def results(self, query):
        """Address, heading and excerpt of every result."""
        self.open("search.html?q=" + query)
        browser.value("""new Promise((done) => { const wait = () => document.querySelector('.search-summary').innerText ? done() :
            setTimeout(wait, 50); wait(); setTimeout(done, 10000); })""")
        self.assertEqual(browser.complaints + browser.requests, [])
        return browser.value("""[...document.querySelectorAll('#search-results li')].map((item) =>
            [item.firstChild.getAttribute('href'), item.firstChild.innerText, item.children[1]?.innerText ?? ''])""")

    def test_the_search_shows_the_text_around_each_hit(self):
        results = self.results("load.torque")
        for page, heading, excerpt in results:
            self.assertTrue(excerpt, heading)
            self.assertLess(len(excerpt), 300, heading)
        for _, heading, excerpt in results[:9]:
            self.assertIn("load.torque", excerpt, heading)
        definitions = [(page, excerpt) for page, _, excerpt in results if page.startswith("docs/scene_reference.html")]
        self.assertEqual([page for page, _ in definitions], ["docs/scene_reference.html#load"])
        self.assertIn("load.torque · 150 N*m", definitions[0][1])
        self.assertEqual(len({page for page, _, _ in results}), len(results), "each section once")
        browser.load(lambda: browser.value("document.querySelector('#search-results a[href*=\"#load\"]').click()"))
        self.assertTrue(browser.value("location.pathname.endsWith('docs/scene_reference.html')"))
        self.assertEqual(browser.value("document.querySelector(location.hash).querySelector('h2').innerText.slice(0, 6)"), "[load]")

    def test_the_search_lists_the_reference_of_a_name_then_user_pages_and_decisions_last(self):
        captions = list(groups_of_contents())
        order = captions[captions.index("Reference"):]
        kinds = {page: caption if caption in order else "User" for caption, pages in groups_of_contents().items() for page in pages}
        for query in ("load.torque", "slip"):
            reference, *found = [page.split(".html")[0] for page, _, _ in self.results(query)]
            self.assertEqual(kinds[reference], "Reference", query)
            found = [kinds.get(page, "Decisions") for page in found]
            self.assertEqual(found[:9], ["User"] * 9, query)
            self.assertIn("Decisions", found, query)
            later = [order.index(kind) for kind in found if kind not in ("User", "Reference")]
            self.assertEqual(later, sorted(later), query)
            self.assertNotIn("User", found[len(found) - len(later):], query)
        self.assertEqual(list(dict.fromkeys(found))[:2], ["User", "Reference"], "pages that contain the query as typed")

    def test_the_sidebar_begins_at_its_top_and_keeps_the_search_field_in_view(self):
        self.addCleanup(browser.resize, 1200, 900)
        for width in (1280, 390):
            browser.resize(width, 900)
            for page in ("docs/index.html", "docs/decisions/sweeps.html"):
                self.open(page)
                if width < 500:
                    browser.value("document.querySelector('i[data-toggle=wy-nav-top]').click()")
                    time.sleep(0.5)   # the menu slides in
                place = browser.value(PLACE)
                self.assertTrue(place["open"], (width, page, place))
                self.assertGreaterEqual(place["entry"][0], place["head"], (width, page))
                self.assertLessEqual(place["entry"][1], place["height"], (width, page))
                self.assertEqual(place["scrolled"] == 0, page == "docs/index.html", (width, page))

    def test_the_sidebar_has_the_groups_of_the_index(self):
        with open(os.path.join(SOURCE, "docs/index.md")) as file:
            guide = file.read().split("\n## ")[1]
        index = {}
        for group, page in re.findall(r"^\| (?:\*\*(.*)\*\*|\[.*?\]\((.*?)\.md\)) \|", guide, re.MULTILINE):
            if group:
                pages = index[group] = []
            else:
                pages.append(os.path.normpath(os.path.join("docs", page)))
        self.assertGreater(len(index), 5)
        self.open("docs/index.html")
        sidebar = browser.value("""[...document.querySelectorAll('.wy-menu-vertical p.caption')].map((caption) => [caption.textContent,
            [...caption.nextElementSibling.querySelectorAll('li.toctree-l1 > a')].map((a) => a.href.split(/[#?]/)[0])])""")
        sidebar = {caption: [os.path.relpath(page.removeprefix("file://"), HTML).removesuffix(".html") for page in pages]
                   for caption, pages in sidebar}
        self.assertIn("docs/index", sidebar.get("Start", []))
        sidebar["Start"].remove("docs/index")
        self.assertEqual([sidebar.get(group) for group in index], list(index.values()))


if __name__ == "__main__":
    with Browser() as browser:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
