"""Sphinx' settings for the pages of this project; run by tools/docs, which names the folder with what Doxygen has read."""

import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))

project = "cvtflow"
author = "The cvtflow authors"
extensions = ["myst_parser", "breathe", "formulas", "excerpts"]
root_doc = "docs/site/contents"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
include_patterns = ["*.md", "docs/**.md", "docs/site/*.rst", "model/*.md"]
exclude_patterns = ["build*", ".*"]
smartquotes = False   # --scene is an option, not a dash
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
myst_update_mathjax = False
myst_disable_syntax = ["myst_line_comment"]   # a line of text may begin with %
suppress_warnings = ["myst.header", "toc.not_included"]
breathe_projects = {"cvtflow": os.environ["CVTFLOW_DOXYGEN"]}
breathe_default_project = "cvtflow"
html_math_renderer = "katex"   # formulas.py
html_theme = "sphinx_rtd_theme"
html_theme_options = {"navigation_depth": 2, "collapse_navigation": False}
html_title = "cvtflow"
html_show_sphinx = False
html_copy_source = False
html_show_search_summary = False   # excerpts.py: a page opened from a file cannot fetch the others
html_show_copyright = False
html_static_path = ["style"]
html_css_files = ["wrap.css"]
