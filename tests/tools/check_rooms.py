#!/usr/bin/env python3
"""check_rooms.py - who may use whom: the table "Rooms" of docs/architecture.md is read, and each #include of and each call into another room
of src/ held to it.

A row may name rooms of rows before it only, so nothing runs upwards and there is no circle of rooms. A room without a row fails, and a
permission that nothing uses. Where a room has a room.h, others include that one alone of it. No circle of files is left in the library: who
calls whom is read from its sources, where a name that begins with bvx_ or bvxi_ belongs to the file that defines it.
"""

import collections
import glob
import re
import sys

MAP = "docs/architecture.md"
DEFINED = re.compile(r"^(?!static|typedef|extern)[a-zA-Z][\w \*]*?\b(bvxi?_\w+)(?:\([^;{]*\)\s*\{|(?:\[[^;{]*)? =)", re.M)
RUNTIMES = "src/core/openmp.c", "src/core/threads.c"
LONGEST_ROOM_H = 150

bad = []


def code_of(path):
    """The text without comments and strings."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    return re.sub(r'"(\\.|[^"\\\n])*"', '""', text)


def room_of(path):
    return path.split("/")[1]


def read_map():
    """Rooms in their order, each with those that it may use."""
    rows, table = {}, False
    with open(MAP, encoding="utf-8") as file:
        for line in file:
            if line.startswith("## "):
                table = line.split() == ["##", "Rooms"]
            if not table or not line.startswith("| `"):
                continue
            name, _, used = [column.strip(" `") for column in line.strip().strip("|").split("|")]
            for other in used.split():
                if other not in rows:
                    bad.append(f"{MAP}: {name} uses {other}, which is no row before it")
            rows[name] = used.split()
    if len(rows) < 5:
        bad.append(f"{MAP}: no table of rooms")
    return rows


def includes_of(path):
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            found = re.match(r'\s*#\s*include\s*"([a-z_0-9]+)/([^"]+)"', line)
            if found:
                yield number, found[1], found[2]


def check_uses(rows, files, calls):
    used = set()

    def use(room, other, where):
        if room == other:
            return
        if room not in rows:
            bad.append(f"{where}: the room {room} is not in {MAP}")
        elif other not in rows[room]:
            bad.append(f"{where}: {room} may not use {other} ({MAP})")
        used.add((room, other))

    doors = {room_of(path) for path in files if path.endswith("/room.h")}
    for path in files:
        for number, other, name in includes_of(path):
            use(room_of(path), other, f"{path}:{number}")
            if other in doors and other != room_of(path) and name != "room.h":
                bad.append(f"{path}:{number}: of {other} others see room.h alone, not {name}")
    for path, others in calls.items():
        for other, names in others.items():
            use(room_of(path), room_of(other), f"{path}: {min(names)}")

    for room, permitted in rows.items():
        for other in permitted:
            if (room, other) not in used:
                bad.append(f"{MAP}: {room} has no need of {other}")
    for room in doors:
        with open(f"src/{room}/room.h", encoding="utf-8") as file:
            lines = len(file.readlines())
        if lines > LONGEST_ROOM_H:
            bad.append(f"src/{room}/room.h: {lines} lines; what others may use is said in {LONGEST_ROOM_H}")


def read_calls(files):
    """By file of the library: the files that it calls, and by which names."""
    texts = {path: code_of(path) for path in files if not room_of(path).startswith("cli_")}
    home = {}
    for path, text in texts.items():
        for name in DEFINED.findall(text) if path.endswith(".c") else []:
            # The two runtimes of parallel work are one file each, of which a build has one.
            if home.setdefault(name, path) != path and {home[name], path} != set(RUNTIMES):
                bad.append(f"{name} is defined in {home[name]} and in {path}")

    calls = collections.defaultdict(lambda: collections.defaultdict(set))
    for path, text in texts.items():
        # What a header declares calls nothing; the bodies of kernels stand in headers and do.
        if path.endswith(".h") and not path.endswith("_body.h"):
            continue
        for name in set(re.findall(r"\bbvxi?_\w+", text)):
            if home.get(name, path) != path:
                calls[path][home[name]].add(name)
    if sum(map(len, calls.values())) < 500:
        bad.append("the calls of the library are not read")
    return calls


def check_circles(calls):
    state, way = {}, []

    def visit(path):
        state[path] = 1
        way.append(path)
        for other in sorted(calls.get(path, ())):
            if state.get(other) == 1:
                circle = way[way.index(other):] + [other]
                names = (f"{a} calls {min(calls[a][b])} of {b}" for a, b in zip(circle, circle[1:]))
                bad.append("circle of files: " + ", ".join(names))
            elif other not in state:
                visit(other)
        state[path] = 2
        way.pop()

    for path in sorted(calls):
        if path not in state:
            visit(path)


def main():
    files = sorted(glob.glob("src/*/*.[ch]"))
    calls = read_calls(files)
    check_uses(read_map(), files, calls)
    check_circles(calls)
    print("\n".join(bad), end="\n" if bad else "")
    sys.exit(bool(bad))


main()
