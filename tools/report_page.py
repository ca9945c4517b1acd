#!/usr/bin/python3
"""A page of a validation report: reads DIR/report.md, writes DIR/report.html, which shows the pictures beside it."""
import argparse
import html
import os
import pathlib

import markdown

from run_folder import program

STYLE = """
body { font: 15px/1.5 sans-serif; color: #1b1b1b; max-width: 76rem; margin: 2rem auto; padding: 0 1.5rem; }
h2 { margin-top: 3rem; border-top: 1px solid #d8d8d8; padding-top: 1.5rem; }
table { border-collapse: collapse; display: block; overflow-x: auto; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid #e4e4e4; padding: 0.25rem 0.7rem; text-align: left; vertical-align: top; }
th { border-bottom-color: #888; }
img { max-width: 100%; }
strong { color: #a3160f; }
"""


def page(text):
    """HTML of a report in Markdown; headings get the anchors that its front page links to."""
    title = next((line.lstrip("# ") for line in text.splitlines() if line.startswith("# ")), "Validation")
    body = markdown.markdown(text, extensions=["tables", "toc"])
    return (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{html.escape(title)}</title>\n'
            f"<style>{STYLE}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path)
    folder = parser.parse_args().folder
    beside = folder / "report.html.part"
    beside.write_text(page((folder / "report.md").read_text()))
    os.replace(beside, folder / "report.html")


if __name__ == "__main__":
    program(main)
