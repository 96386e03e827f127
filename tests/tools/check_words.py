#!/usr/bin/env python3
"""check_words.py - comments, messages and pages say it in plain English.

Each row of WORDS is what stands where something plainer is said instead, and that. Looked through are comments and messages of the C
sources and of the header, docstrings and messages of the Python package, and the pages. A line that must say it all the same is in KEPT.
"""

import re
import subprocess
import sys

WORDS = [
    (r"\bone behind (the other|another)\b", "one after the other"),
    (r"\bbehind the (last|first|head|header|data|end of)\b", "after"),
    (r"\bround (the|its|every|each|them) (axis|edge|cell|hole|mesh|vertex|region|voxel|circle)\b", "around"),
    (r"\bis no (command|operation|option|grid|octree|whole number)\b", "unknown ..., or is not a ..."),
    (r"\b(grid|lattice|field|view|mesh|window|arrays) that (is|are) none\b", "invalid"),
    (r"\b(is|are) '?[\w%-]+'? meant\?", "did you mean ...?"),
    (r"\b(what|where|is|are|was|were) asked for\b", "requested"),
    (r"\btells (whether|how|which|what|where|when|the|its)\b", "says, reports, gives"),
    (r"\btold (apart|of each)\b", "distinguished, reported"),
    (r"\bcannot tell\b", "cannot decide, does not distinguish"),
    (r"\b(vertex|triangle) numbers?\b", "index"),
    (r"\bwith its number\b", "with its index"),
    (r"\b(goes|go) with (the rule|body)\b", "requires, is used with"),
    (r"\bare left over\b|\bis left over\b", "remain"),
    (r"\bhand(s|ed)? (on|back)\b", "pass on, return"),
    (r"\b(gives?|given|takes?|taken) back to the (allocator|caller)\b", "freed, returned"),
    (r"\b(which|that) \w+ has not\b[.,;]", "does not have"),
]
# Python's users write American; the names of the C library's fields and of the program's options are what they are.
AMERICAN = [
    (r"\bunless told\b", "by default"),
    (r"\bso many of\b", "this many of"),
    (r"(?<![.\w-])_?colour\w*", "color"),
    (r"(?<![.\w])_?centre\w*", "center, centered"),
    (r"(?<![.\w-])_?neighbour\w*", "neighbor"),
    (r"\b\w*(behaviour|favour|honour|labour|flavour|rigour)\w*", "-or"),
    (r"\b(centi|milli|kilo|micro)?metres?\b|\b(fibre|litre)s?\b", "-er"),
    (r"\bgrey\b", "gray"),
    (r"\b(licence|defence|offence)\b", "-se"),
    (r"\b(catalogue|analogue|dialogue)s?\b", "-og"),
    (r"\b(model|label|travel|signal|channel|level)l(ed|ing)\b", "one l"),
    (r"\b(voxel|triangul|initial|normal|optim|minim|maxim|recogn|organ|real|summar|visual|general|special|quant|serial|token|parametr|"
     r"symmetr|local|character|categor|emphas|synchron|random|rasters?|discret|polygon|tetrahedral)is(e[sdr]?|ing|ations?)\b", "-ize"),
    (r"\banalys(e[sd]?|ing)\b", "analyze"),
]
OF_THE_LIBRARY = {  # where names and words of C or of the program become ours, and a misspelled name that must be refused
    "bindings/python/csource.py": "colour centre neighbour",
    "bindings/python/src/bitvox/_run.py": "colour centre neighbour",
    "bindings/python/src/bitvox/_stages.py": "colours",
    "bindings/python/tests/test_program.py": "neighbourhood",
    "bindings/python/tests/test_command.py": "voxelise",
    "bindings/python/tests/test_types.py": "voxelise",
}
KEPT = [
    "tests/unit/test_read_ply.c",  # what a generator meant is not a message
]


def texts(path, text):
    """Pairs of line and text that people read."""
    if path.endswith((".c", ".h")):
        for found in re.finditer(r'"(?:[^"\\\n]|\\.)*"|/\*.*?\*/', text, re.S):
            words = re.sub(r"\n\s*\*?\s*", " ", found.group(0))
            yield text.count("\n", 0, found.start()) + 1, words
    elif path.endswith(".py"):
        for found in re.finditer(r'"""(.*?)"""|"(?:[^"\\\n]|\\.)*"|#[^\n]*', text, re.S):
            yield text.count("\n", 0, found.start()) + 1, re.sub(r"\s+", " ", found.group(0))
    else:
        for paragraph in re.finditer(r"(?:.+\n)+", text):
            yield text.count("\n", 0, paragraph.start()) + 1, paragraph.group(0).replace("\n", " ")


def faults(path, line, words, rows):
    """What rows say against a text."""
    kept = OF_THE_LIBRARY.get(path, "").split()
    found = [(match.group(0), better) for pattern, better in rows for match in re.finditer(pattern, words)]
    return [f"error: {path}:{line}: '{said}'; say: {better}" for said, better in found if said not in kept]


def main():
    listed = subprocess.run(["git", "ls-files", "src", "include", "tests/unit", "tests/fault", "tests/fuzz", "tests/golden", "docs", "README.md",
                             "CONTRIBUTING.md", "bindings/python"], capture_output=True, text=True, check=True).stdout.split()
    wrong = []
    for path in listed:
        if not path.endswith((".c", ".h", ".py", ".md", ".ipynb")) or path in KEPT:
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        ours = path.startswith("bindings/python/")
        rows = [] if path.startswith("bindings/python/tests/") else WORDS
        for line, words in texts(path, text):
            wrong += faults(path, line, words, rows + AMERICAN if ours else rows)
        if ours:  # names too; members of C structs stand after a point
            for line, words in enumerate(text.split("\n"), 1):
                wrong += faults(path, line, words, AMERICAN)
    print("\n".join(dict.fromkeys(wrong)))
    return 1 if wrong else 0


sys.exit(main())
