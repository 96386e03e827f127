#!/usr/bin/env python3
"""house.py - what the sources look like in numbers: a table of rooms, and the figures that pages are measured by.

A body is what stands between braces at the start of a line. Comments in bodies are lines that are nothing else.
"""

import glob
import re
import statistics

COLUMNS = 110
COMMENT = re.compile(r"\s*(/\*|\*|//)")


def bodies(lines):
    start = None
    for i, line in enumerate(lines):
        if line == "{":
            start = i + 1
        elif line == "}" and start is not None:
            yield lines[start:i]
            start = None


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read().split("\n")


def comment_lines(lines):
    """Lines with nothing but a comment: also the later lines of one that began after code, as those of fields do."""
    inside = 0
    count = 0
    for line in lines:
        count += bool(COMMENT.match(line) if not inside else True)
        opened, closed = line.rfind("/*"), line.rfind("*/")
        inside = opened > closed if opened >= 0 else inside and closed < 0
    return count


def share(part, whole):
    return f"{100 * part / max(1, whole):.1f} %"


def measure(paths):
    files = {path: read(path) for path in paths}
    every = [body for lines in files.values() for body in bodies(lines)]
    long = [body for body in every if len(body) >= 8]
    lines = sum(len(f) for f in files.values())
    lengths = sorted(len(body) for body in every) or [0]
    return {
        "files": len(files),
        "lines": lines,
        "median, longest file": f"{int(statistics.median(len(f) for f in files.values()))}, {max(len(f) for f in files.values())}",
        "functions, median and nine tenths": f"{int(statistics.median(lengths))}, {lengths[9 * len(lengths) // 10]}",
        "bodies of 8 lines with a blank one": share(sum("" in map(str.strip, b) for b in long), len(long)),
        "comment lines in them": share(sum(bool(COMMENT.match(x)) for b in long for x in b), sum(map(len, long))),
        f"lines over {COLUMNS}": share(sum(len(x) > COLUMNS for f in files.values() for x in f), lines),
    }


def main():
    rooms = sorted({path.split("/")[1] for path in glob.glob("src/*/*.[ch]")})
    table = {room: measure(glob.glob(f"src/{room}/*.[ch]")) for room in rooms}
    table["all"] = measure(glob.glob("src/*/*.[ch]"))
    names = list(table["all"])

    print("| room | " + " | ".join(names) + " |")
    print("|---|" + "--:|" * len(names))
    for room, row in table.items():
        print(f"| {room} | " + " | ".join(str(row[name]) for name in names) + " |")

    includes = [sum(x.startswith('#include "') for x in read(path)) for path in glob.glob("src/*/*.c")]
    header = read("include/bitvox.h")
    tests = sum(len(read(path)) for path in glob.glob("tests/**/*.[ch]", recursive=True))
    print(f"\nincludes of a .c file, median: {int(statistics.median(includes))}")
    print(f"header: {len(header)} lines, {share(comment_lines(header), len(header))} comments")
    print(f"tests : sources, in lines: {tests / table['all']['lines']:.2f}")


main()
