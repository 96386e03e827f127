#!/usr/bin/env python3
"""walk.py COMMAND...: the way of a run through the program's sources.

Follows `run` from cli_perform through the functions of a command's job (choose, and which the job names: make, tell, free) and all calls
that pass it, in the order of the text, each body once: a step down for each call, a step back after it. Prints for each job of the command
the files and functions on the way, the stays (runs of steps within one file), the returns (stays in a file that was seen before: stays less
files) and the climbs (calls into a room above the caller's). With --every, calls that do not pass `run` are followed too; --list names the
files with their stays."""
import glob
import re
import sys

ROOMS = ["cli_shell", "cli_args", "cli_inputs", "cli_results", "cli_commands"]


def plain(text):
    """The same text without comments, strings and preprocessor lines; lengths are kept by spaces."""
    text = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', lambda m: re.sub(r"[^\n]", " ", m.group()), text,
                  flags=re.S)
    return re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.M)


def close_of(text, at, pair):
    depth = 0
    for i in range(at, len(text)):
        depth += (text[i] == pair[0]) - (text[i] == pair[1])
        if depth == 0:
            return i
    raise ValueError("no end")


def functions(path):
    """(name, body, static) of each function of a file."""
    text = plain(open(path, encoding="utf-8").read())
    for m in re.finditer(r"^(?P<head>[A-Za-z_][\w \t*]*?[ *])(?P<name>\w+)\((?P<args>[^;{}]*?)\)\s*\{", text, flags=re.M):
        end = close_of(text, m.end() - 1, "{}")
        yield m.group("name"), text[m.end():end], "static" in m.group("head")


def read_program():
    own, shared = {}, {}
    for room in ROOMS:
        for path in sorted(glob.glob(f"src/{room}/*.c")):
            for name, body, static in functions(path):
                (own.setdefault(path, {}) if static else shared)[name] = (path, name, body)
    return own, shared


def calls(body, every):
    """Names of what is called, in the order of the text, where `run` (or anything, with every) is handed on."""
    for m in re.finditer(r"\b(\w+)\s*\(", body):
        args = body[m.end() - 1:close_of(body, m.end() - 1, "()") + 1]
        if every or re.search(r"\brun\b(?!\s*(->|\.))", args):
            yield m.group(1)


def walk(entry, own, shared, every):
    steps, seen, climbs = [], set(), 0

    def enter(function):
        nonlocal climbs
        path, name, body = function
        steps.append(path)
        if (path, name) in seen:
            return
        seen.add((path, name))
        for callee in calls(body, every):
            to = own.get(path, {}).get(callee) or shared.get(callee)
            if to is None:
                continue
            climbs += ROOMS.index(to[0].split("/")[1]) > ROOMS.index(path.split("/")[1])
            enter(to)
            steps.append(path)

    for function in entry:
        enter(function)
    stays = [p for i, p in enumerate(steps) if i == 0 or steps[i - 1] != p]
    return seen, stays, climbs, len(steps)


def jobs_of(command, own):
    """(name, functions) of each job of a command: the one in its table, or those that its choose_ names."""
    path = f"src/cli_commands/cmd_{command}.c"
    text = open(path, encoding="utf-8").read()
    found = {}
    for file in sorted(glob.glob("src/cli_commands/*.c")):
        for m in re.finditer(r"^(?:static )?const cli_job (\w+) = \{(.*?)\};", open(file, encoding="utf-8").read(), flags=re.M | re.S):
            found[m.group(1)] = (file, m.group(2))
    choose = own[path].get(f"choose_{command}")
    if choose is None:
        named = {command: (path, re.search(r"\.job = \{(.*?)\}", text, flags=re.S).group(1))}
    else:
        named = {f"{command} {name}": found[name] for name in re.findall(r"\b\w+_\w+\b", choose[2]) if name in found}
    for name, (file, parts) in named.items():
        functions = [own[file].get(part) for part in re.findall(r"\.(?:make|tell|free) = (\w+)", parts)]
        yield name, [f for f in [choose, *functions] if f]


def main():
    words = [w for w in sys.argv[1:] if not w.startswith("--")]
    sys.setrecursionlimit(10000)
    own, shared = read_program()
    for command in words or ["voxelize"]:
        for name, functions in jobs_of(command, own):
            seen, stays, climbs, steps = walk([shared["cli_perform"], *functions], own, shared, "--every" in sys.argv)
            files = {p for p, _ in seen}
            print(f"{name}: {len(files)} files, {len(seen)} functions, {steps} steps, {len(stays)} stays, "
                  f"{len(stays) - len(files)} returns, {climbs} climbs")
            if "--list" in sys.argv:
                for p in sorted(files, key=lambda p: -stays.count(p)):
                    print(f"  {stays.count(p):4} {p}")


main()
