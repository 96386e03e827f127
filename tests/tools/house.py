#!/usr/bin/env python3
"""house.py - what the sources look like in numbers: a table of rooms, the figures that pages are measured by, and their goals.

A body is what stands between braces at the start of a line. Comments in bodies are lines that are nothing else.
"""

import glob
import os
import re
import statistics
import subprocess
import sys

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
        return file.read().splitlines()


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


GOALS = {
    "files": "300",
    "lines": "47000",
    "median, longest file": "180, 700",
    "functions, median and nine tenths": "12, 35",
    "bodies of 8 lines with a blank one": "70 %",
    "comment lines in them": "8 %",
    f"lines over {COLUMNS}": "0.0 %",
}


def print_rooms():
    names = sorted({path.split("/")[1] for path in glob.glob("src/*/*.[ch]")})
    table = {room: measure(glob.glob(f"src/{room}/*.[ch]")) for room in names}
    table["all"] = measure(glob.glob("src/*/*.[ch]"))
    table["goal of all"] = GOALS

    print("| room | " + " | ".join(GOALS) + " |")
    print("|---|" + "--:|" * len(GOALS))
    for room, row in table.items():
        print(f"| {room} | " + " | ".join(str(row[name]) for name in GOALS) + " |")
    return table["all"]


REPEATED_RUN = 6  # lines


def repeated_code(paths):
    """Share of the lines of code in runs of six and more that stand somewhere else too; blank lines and comments aside."""
    lines, places = {}, {}
    for path in paths:
        code = re.sub(r"/\*.*?\*/", "", "\n".join(read(path)), flags=re.S).split("\n")
        lines[path] = [line for line in map(str.strip, code) if line and not line.startswith("#include")]
        for i in range(len(lines[path]) - REPEATED_RUN + 1):
            places.setdefault(tuple(lines[path][i : i + REPEATED_RUN]), []).append((path, i))
    repeated = {(path, i + k) for runs in places.values() if len(runs) > 1 for path, i in runs for k in range(REPEATED_RUN)}
    return share(len(repeated), sum(map(len, lines.values())))


def changing_state(paths):
    """Variables of files and functions that are not constant; of the library check_house.sh looks at the objects too."""
    state = re.compile(r"^\s*static (?!inline\b)(?![^=;(]*\bconst\b)[\w \*]+(?:\[[^\]]*\])*(?: =|;)", re.M)
    return sum(len(state.findall(plain(path))) for path in paths)


def complaints(*command):
    """Lines of a check that holds when it prints none."""
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()


def print_side_by_side(every):
    """The table of section 7 in the study that set these goals, for the library and the program together."""
    sources, header = glob.glob("src/*/*.[ch]"), read("include/bitvox.h") + read("include/bitvox_io.h")
    library = [path for path in sources if not path.startswith("src/cli_")]
    code = [path for path in sources if not path.endswith("surface/tables.h")]
    lines = [line for path in sources for line in read(path)]
    tests = sum(len(read(path)) for path in glob.glob("tests/**/*.[ch]", recursive=True))
    includes = [sum(x.startswith("#include ") for x in read(path)) for path in sources if path.endswith(".c")]
    uses = complaints(sys.executable, "tests/tools/check_rooms.py")
    circles = [x for x in uses if "circle" in x] + complaints("sh", "tests/tools/check_circles.sh")
    has = [os.path.exists("CONTRIBUTING.md"), os.path.exists(".clang-format")]

    print("\n| all of src | now | goal |\n|---|--:|--:|")
    for what, now, goal in (
        ("source files / lines", f"{every['files']} / {every['lines']}", "300 / 47000"),
        ("median, longest file", every["median, longest file"], "180, 700"),
        ("functions, median and nine tenths", every["functions, median and nine tenths"], "12, 35"),
        ("bodies of 8 lines with a blank one", every["bodies of 8 lines with a blank one"], "70 %"),
        ("own-line comments in bodies of 8 lines", every["comment lines in them"], "8 %"),
        ("own-line comments, all", share(sum(comment_lines(read(path)) for path in sources), len(lines)), "12 %"),
        ("lines over 120 columns", sum(len(line) > 120 for line in lines), "0"),
        ("includes of a .c file, median", int(statistics.median(includes)), "2 to 3"),
        ("headers: lines, comments", f"{len(header)}, {share(comment_lines(header), len(header))}", "2000, 50 %"),
        ("uses against the order of rooms", sum("circle" not in x for x in uses), "0"),
        ("circles of files", len(circles), "0"),
        (f"repeated code, runs of {REPEATED_RUN} lines", repeated_code(code), "< 1 %"),
        ("global state that changes: library, program", f"{changing_state(library)}, {changing_state(set(sources) - set(library))}", "0, -"),
        ("tests : sources, in lines", f"{tests / every['lines']:.2f}", "0.9"),
        ("README kB / files of docs", f"{os.path.getsize('README.md') / 1000:.0f} / {len(glob.glob('docs/*.md'))}", "10 / 8"),
        ("CONTRIBUTING, formatter", ", ".join("yes" if x else "no" for x in has), "yes, yes"),
        ("callers that parse error text", "check_house.sh", "0"),
        ("facts kept in three places", "check_house.sh", "0"),
        ("a stranger names the file of a stage", "judged", "yes"),
    ):
        print(f"| {what} | {now} | {goal} |")


# What the rooms are held to (docs/architecture.md): counted in the library, without the program.
DEFINITION = re.compile(r"^(?!#)[A-Za-z_][\w \*]*?\b(\w+)\(([^;{}]*)\)\s*\n\{", re.M)
PLAIN_SIZE = re.compile(r"^\w+$")  # of a free: a name alone
# Structs with values of their own on the set voxels of a grid say where those of each row begin.
STRUCT = re.compile(r"^(?:typedef )?struct \w* ?\{\n(.*?)^\}", re.M | re.S)
OF_ROWS = re.compile(r"\[Size:\s+rows \+ 1\]")


def plain(path):
    """The code of a file, without comments and the lines of macros."""
    text = re.sub(r"/\*.*?\*/", "", "\n".join(read(path)), flags=re.S)
    return re.sub(r"^#.*(?:\\\n.*)*", "", text, flags=re.M)


def arguments(text):
    """Top-level commas of a list of parameters, plus one."""
    return len(re.sub(r"\([^()]*\)", "", text).split(","))


def vector_lines(text):
    """Lines of functions that name intrinsics of one machine."""
    count = 0
    for body in re.finditer(r"^\w[^\n;{}]*\([^;{}]*\)\s*\n\{\n.*?^\}", text, re.M | re.S):
        if re.search(r"\b_mm\d*_", body[0]):
            count += body[0].count("\n") + 1
    return count


def print_library():
    paths = [p for p in sorted(glob.glob("src/*/*.[ch]")) if not p.startswith("src/cli_")]
    code = {path: plain(path) for path in paths}
    every = "\n".join(code.values())
    frees = [call.rsplit(",", 1)[1].strip() for call in re.findall(r"\bbvxi_free\(([^;]*)\);", every) if call.count(",") >= 2]
    sparse = sum(bool(OF_ROWS.search(m[1])) for path in paths for m in STRUCT.finditer("\n".join(read(path))))
    engines = sum(any(p.endswith("/" + name) for p in paths) for name in ("closest.h", "nearest_tree.h"))
    lengths = [len(read(path)) for path in paths]

    print("\n| the library | now | goal |\n|---|--:|--:|")
    for what, count, goal in (
        ("functions of eight and more arguments", sum(arguments(m[2]) >= 8 for t in code.values() for m in DEFINITION.finditer(t)), "< 5"),
        ("frees that compute a size", sum(not PLAIN_SIZE.match(size) for size in frees), "< 50"),
        ("structs of values on set voxels, bvx_field of the header aside", sparse, "1"),
        ("trees for nearest points", engines, "1"),
        ("lines that x86 alone has, core/simd_avx2.h aside", sum(vector_lines(t) for p, t in code.items() if "simd_avx2" not in p), "< 200"),
        ("files", len(paths), "about 300"),
        ("median length of a file", int(statistics.median(lengths)), "150 to 200"),
        ("files of fewer than 50 lines", sum(n < 50 for n in lengths), "few"),
        ("lines of \"if (status == BVX_OK\"", len(re.findall(r"if \(status == BVX_OK", every)), "few"),
    ):
        print(f"| {what} | {count} | {goal} |")


print_side_by_side(print_rooms())
print_library()
