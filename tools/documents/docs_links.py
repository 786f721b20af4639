"""Checks that every link inside a folder of HTML pages leads to a file and an anchor that are there.

    tools/documents/docs_links.py DIR

Exit status 1 if one does not; every such link is printed. Addresses on the web are not looked at.
"""

import pathlib
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlparse


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.anchors, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            if value and ((tag == "a" and name == "href") or (tag == "img" and name == "src")):
                self.links.append(value)


def main(folder):
    root = pathlib.Path(folder).resolve()
    pages = {path: Page(path.read_text()) for path in root.rglob("*.html")}
    wrong, followed = 0, 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlparse(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            followed += 1
            known = pages.get(target)
            if not target.exists() or (parts.fragment and known and unquote(parts.fragment) not in known.anchors):
                print(f"{path.relative_to(root)}: {link}")
                wrong += 1
    print(f"{followed} links on {len(pages)} pages, {wrong} lead nowhere")
    return 1 if wrong or not followed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
