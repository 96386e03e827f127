"""page.py - tables of pages from one run of `make bench`.

    page.py fill REPORT.json PAGE...     puts the tables in
    page.py check REPORT.json PAGE...    ends with 1 where a table is not that of the report, was not measured, or where docs/measured.md
                                         has a figure with a unit outside of its tables

A page says where a table goes: a line `<!-- bench: TEXT N -->` before it, for the Nth table of the report's text of that name.
"""
import json
import re
import sys

MARK = re.compile(r"<!-- bench: (\S+) (\d+) -->")
FIGURE = re.compile(r"(?<![\w.,])\d[\d,]*(?:\.\d+)? (?:(?:ms|s|us|ns|MiB|MB|GB|MB/s|GB/s|times)\b|%)")
MISSING = "not measured"


def tables(text):
    """The tables of a text, each as its lines."""
    found, last = [], ""
    for line in text.splitlines():
        if line.startswith("|"):
            if not last.startswith("|"):
                found.append([])
            found[-1].append(line)
        last = line
    return found


def filled(page, texts):
    """The page's lines with the tables of the report."""
    out, lines, at = [], page.splitlines(), 0
    while at < len(lines):
        out.append(lines[at])
        mark = MARK.fullmatch(lines[at])
        at += 1
        if not mark:
            continue
        name, number = mark[1], int(mark[2])
        own = tables(texts.get(name, ""))
        out.append("")
        out.extend(own[number - 1] if number <= len(own) else [f"| {name}: {MISSING} |", "|---|"])
        while at < len(lines) and (lines[at] == "" or lines[at].startswith("|")):
            at += 1
        out.append("")
    return out


def strange(page):
    """Figures with a unit outside of tables."""
    return [figure for line in page.splitlines() if not line.startswith("|") for figure in FIGURE.findall(line)]


def main():
    action, report, *pages = sys.argv[1:]
    with open(report, encoding="utf-8") as file:
        texts = json.load(file)["texts"]
    bad = 0
    for name in pages:
        with open(name, encoding="utf-8") as file:
            page = file.read()
        new = "\n".join(filled(page, texts)) + "\n"
        if action == "fill":
            with open(name, "w", encoding="utf-8") as file:
                file.write(new)
        elif new != page:
            print(f"{name}: its tables are not those of {report}; `make bench-pages` puts them in")
            bad = 1
        faults = [f"{figure} stands outside of the tables" for figure in strange(new)] if name.endswith("measured.md") else []
        faults += ["a table was not measured"] * (MISSING in new)
        for fault in faults if action == "check" else []:
            print(f"{name}: {fault}")
            bad = 1
    sys.exit(bad)


main()
