#!/usr/bin/env python3
"""check_options.py WORK ARCHIVE, or check_options.py PROGRAM, whose archive stands beside it - what is said of options in five places agrees.

The comments of both headers are read: each field of an option struct has 0 as its default or says another by [Default: ]. A number has its
[Limit: ], names the list it chooses from (BVX_CAPS_...), or is a switch, "1: ...". Then:

- where the default is not 0, the field's row in the library says the same;
- each call with such options refuses the nearest value outside the limit, by the field's name and with the reason of a range or a
  choice, and takes those at its ends;
- the program's rows for the field take no more and no less, and their help says the same default;
- the functions of the Python package have the same default, and check the same range.

What a place calls otherwise, or has for itself, stands below: SYNONYMS, OWN and LATER. A new field, row or argument that is in none fails.
"""

import ast
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

if len(sys.argv) == 2:
    FOLDER = tempfile.TemporaryDirectory()
    WORK, ARCHIVE = Path(FOLDER.name), str(Path(sys.argv[1]).with_name("libbitvox.a"))
else:
    WORK, ARCHIVE = Path(sys.argv[1]), sys.argv[2]
HEADER = "".join(Path(f"include/{name}.h").read_text() for name in ("bitvox", "bitvox_io"))
problems = []
exec(Path("tests/tools/option_exceptions.py").read_text())


def wrong(where, what):
    problems.append(f"{where}: {what}")


# ---- The header ----

LISTS = {}
for found in re.finditer(r"#define BVX_(\w+)_LIST\(X\)(.*?)(?=\n\S|\n\n)", HEADER, re.S):
    rows = re.findall(r'X\((BVX_\w+), (\d+),[\s\\]*"([^"]*)"\)', found.group(2))
    LISTS[found.group(1)] = {name: (int(number), text) for name, number, text in rows}
NAMES = {name: value[0] for rows in LISTS.values() for name, value in rows.items()}
NAMES |= {name: int(value) for name, value in re.findall(r"\b(BVX_[A-Z0-9_]+) = (-?\d+)\b", HEADER)}
NAMES |= {"BVX_FILLS_OF_BOOLEAN": None, "BVX_FILLS_OF_REPAIR": None, "BVX_FILLS_OF_FIELD": None, "BVX_LABEL_ZERO": -(2**31)}


def bits(name):
    """The numbers of a set such as BVX_FILLS_OF_BOOLEAN."""
    text = re.search(name + r" = (1 << .*?)(?:\n\s*\}|,\n|,\s*/)", HEADER, re.S).group(1)
    return sorted(NAMES[one] for one in re.findall(r"1 << (BVX_\w+)", text))


def number(text):
    """ "2^24", "BVX_F32", "-infinity", "0.5"; None where it is none."""
    text = text.strip()
    if text in NAMES:
        return NAMES[text]
    text = text.replace("infinity", "1e999").replace("^", "**")
    if not re.fullmatch(r"-?[0-9.e]+(\*\*\d+)?(-1)?", text):
        return None
    return eval(text)


# What holds for every field of a name: the header's Types, at its top.
STANDING = {"position_type": "0..2", "local_frame": "0..1"}


class Field:
    def __init__(self, struct, type, name, length, comment):
        self.struct, self.type, self.name, self.length, self.comment = struct, type, name, length, comment
        tag = lambda word: (re.findall(rf"\[{word}: ([^\]]*)\]", comment) or [None])[0]
        self.default, self.limit = tag("Default") or ("NULL" if "*" in type else "0"), tag("Limit") or STANDING.get(name)
        if self.limit is None and comment.startswith("/**< 1: "):
            self.limit = "0..1"
        self.whole, self.real = type in ("int32_t", "uint64_t", "uint8_t"), type == "double"
        self.pieces = self.read_limit() if self.whole or self.real else None
        self.none = "BVX_NONE" in (self.limit or "")
        self.path = name

    def where(self):
        return f"include: {self.struct}.{self.name}"

    def read_limit(self):
        """Ranges as (low, low is in it, high, high is in it); an end that another field says is None. [] where all is allowed."""
        if self.limit is None:
            lists = [LISTS[one] for one in re.findall(r"BVX_([A-Z]+)_\.\.\.", self.comment) if one in LISTS]
            if len(lists) == 1:
                values = [value for value, _ in lists[0].values()]
                return [(min(values), True, max(values), True)]
            return None
        limit = self.limit.split(";")[0]
        if limit == "any":
            return []
        if (self.limit or "").startswith("BVX_FILLS_OF_"):
            return [(one, True, one, True) for one in bits(self.limit)]
        pieces = []
        for part in re.split(r", or ", limit):
            found = re.fullmatch(r"(\S+)\.\.(\S+)", part)
            between = re.fullmatch(r"> (\S+), < (\S+)", part)
            above = re.fullmatch(r"(>=?) (\S+)", part)
            if found:
                pieces.append((number(found.group(1)), True, number(found.group(2)), True))
            elif between:
                pieces.append((number(between.group(1)), False, number(between.group(2)), False))
            elif above:
                pieces.append((number(above.group(2)), above.group(1) == ">=", None, True))
            elif number(part) is not None:
                pieces.append((number(part), True, number(part), True))
            else:
                wrong(self.where(), f"[Limit: {self.limit}] cannot be read; write a..b, > a, >= a, '> a, < b' or a number, with ', or ' between")
        return pieces

    def inside(self, value):
        def after(v, low, closed):
            return low is None or v > low or (closed and v == low)

        return not self.pieces or any(after(value, a, x) and after(-value, None if b is None else -b, y) for a, x, b, y in self.pieces)

    def tries(self):
        """Values at the ends, and the nearest ones beyond."""
        taken, refused = [], []
        step = 1 if self.whole else 2.0**-10
        for low, has_low, high, has_high in self.pieces or []:
            for end, closed, sign in ((low, has_low, -1), (high, has_high, 1)):
                if end is None or abs(end) == float("inf"):
                    continue
                taken.append(end if closed else end - sign * step)
                refused.append(end + sign * step if closed else end)
        smallest = 0 if self.type in ("uint64_t", "uint8_t") else -(2**31)
        largest = 2**31 - 1 if self.type == "int32_t" else 2**64 - 1
        fits = [v for v in refused if v != 0 and not self.inside(v) and (self.real or smallest <= v <= largest)]  # 0 is the default
        return taken, sorted(set(fits)) + (["NAN"] if self.real and self.pieces else [])


STRUCTS, SHARED = {}, {}  # SHARED: structs that options have by value; their fields are the options'
for found in re.finditer(r"typedef struct bvx_(\w+?)(_options|(?<=fit)|(?<=placing)|(?<=parts)|(?<=targets)|(?<=collapse)|(?<=allocator)|(?<=arena)|(?<=parallel)|(?<=progress)|(?<=sampling)|(?<=slabs)|(?<=camera)|(?<=bvx_cut)) \{\n(.*?)\n\} ", HEADER, re.S):
    fields = (STRUCTS if found.group(2) else SHARED)[found.group(1)] = {}
    kind = "bvx_" + found.group(1) + "_options"
    body = re.sub(r"/\*(?!\*<).*?\*/", "", found.group(3), flags=re.S)
    for line in re.finditer(r"([^;/]*?);[ \t]*(/\*\*<.*?\*/)?", body, re.S):
        told = " ".join((line.group(2) or "").split())
        words = " ".join(line.group(1).split())
        type, names = re.fullmatch(r"((?:const )?\w+)(.*)", words).groups()
        for at, name in enumerate(names.split(",")):
            stars, plain, length = re.fullmatch(r"((?:[ *]|const )*)(\w+)(?:\[(\d+)\])?", name.strip()).groups()
            for inner in SHARED.get(type.removeprefix("bvx_"), {}).values():
                fields[inner.name] = Field(kind, inner.type, inner.name, inner.length, inner.comment)
                fields[inner.name].at, fields[inner.name].path = inner.at, f"{plain}.{inner.name}"
            if type.removeprefix("bvx_") not in SHARED:
                fields[plain] = Field(kind, type + " *" * stars.count("*"), plain, int(length or 1), told)
                fields[plain].at = at
fields = [f for of in STRUCTS.values() for f in of.values() if f.name != "struct_size" and not f.name.startswith("reserved")]
if len(fields) < 150:
    wrong("include/bitvox.h", f"only {len(fields)} fields of options were read")
for f in fields:
    if (f.whole or f.real) and f.pieces is None:
        wrong(f.where(), 'has no [Limit: ...], names no list such as BVX_CAPS_... and is no switch "1: "; write [Limit: any] where all numbers are allowed')


def default_of(f):
    """Numbers, "NULL", or None where the header says it in words."""
    if re.match(r"NULL\b|the ", f.default):
        return "NULL" if f.default.startswith("NULL") else None
    if f.default.startswith("all zero"):
        return [0]
    parts = re.match(r"(-?[\w.^+-]+)((?:, -?[\d.]+(?![\w^]))*)", f.default)
    values = [number(one) for one in re.split(", ", parts.group(1) + parts.group(2))] if parts else [None]
    return None if None in values else values[f.at :] or values[-1:]


# ---- The library ----

CALLS = {}
table = Path("tests/unit/call_table.h").read_text()
for found in re.finditer(r"static bvx_status (\w+)\(const world \*w\)\s*\\?\n\{(.*?)\n\}", table, re.S):
    kind = re.search(r"TAKE_OPTIONS\((\w+), o\)", found.group(2))
    if kind:
        CALLS.setdefault(kind.group(1), found.group(1))
    elif "RENDER_OPTIONS;" in found.group(2):
        CALLS.setdefault("render", found.group(1))
CALLS |= {"levels": "build_levels", "morph": "grid_morph", "extract": "extract_surface"}


def literal(value):
    if value == "NAN":
        return "(double)NAN"
    if value in (float("inf"), -float("inf")):
        return "(double)INFINITY" if value > 0 else "-(double)INFINITY"
    return f"{value}.0" if isinstance(value, int) else repr(value)


def library():
    lines = []
    for kind, of in STRUCTS.items():
        for f in of.values():
            if f.name == "struct_size":
                continue
            at = f'"{kind}", "{f.name}"'
            size = f"offsetof({f.struct}, {f.path}), sizeof ((({f.struct} *)0)->{f.path})"
            shape = "REAL" if f.real else "WIDE" if f.type == "uint64_t" else "BYTE" if f.type == "uint8_t" else "WHOLE" if f.type == "int32_t" else "BLOCK"
            if kind not in CALLS or f.name.startswith("reserved") or f.length > 1 or not f.pieces:
                continue
            taken, refused = f.tries()
            for value in taken:
                lines.append(f"    taken({at}, {CALLS[kind]}, {size}, {shape}, {literal(value)});")
            for value in refused:
                lines.append(f"    refused({at}, {CALLS[kind]}, {size}, {shape}, {literal(value)});")
    (WORK / "option_rows.h").write_text("static void all_rows(void)\n{\n" + "\n".join(lines) + "\n}\n")
    for kind in STRUCTS:
        if kind not in CALLS and kind != "context":
            wrong("tests/unit/call_table.h", f"no call takes bvx_{kind}_options")


def standards():
    """What 0 stands for: the rows BVXI_OR, and the fields of BY_HAND."""
    sources = "".join(path.read_text() for path in sorted(Path("src").glob("*/*.[ch]")))
    numbers = dict(re.findall(r"(?:#define|enum \{) (\w+) +(?:= )?(-?[\d.e-]+)", sources))
    sources = re.sub(r"BVXI_TARGETS\((bvx_\w+)\)", r"BVXI_OR(\1, targets.even, REAL, BVXI_EVEN,", sources)
    sources = re.sub(r"BVXI_COLLAPSE\((bvx_\w+)\)", r"BVXI_OR(\1, collapse.attribute_weight, REAL, BVXI_WEIGHT,", sources)
    rows = {(struct, field): standard for struct, field, standard in re.findall(r"BVXI_OR\(\s*(bvx_\w+), ([\w.]+), \w+, ([\w.]+),", sources)}
    for f in fields:
        told, row = default_of(f), rows.pop((f.struct, f.path), None)
        if told in (None, "NULL") or not any(told[: f.length]) or (f.struct, f.name) in BY_HAND:
            continue
        found = number(numbers.get(row, row)) if row is not None else NAMES.get(f.default)
        if found != told[0]:
            wrong(f.where(), f"[Default: {f.default}], but 0 stands for {row} in the library's row")
    for one in rows.keys() - BY_HAND.keys():
        wrong(f"{one[0]}.{one[1]}", "has a row BVXI_OR, the header no such default")


def program_sources():
    """All of the program but its main."""
    return [str(path) for path in sorted(Path("src").glob("cli_*/*.c")) if path.name != "main.c"]


def built():
    library()
    standards()
    program = WORK / "option_contract"
    needed = subprocess.run([os.environ.get("MAKE_COMMAND", "make"), "-s", "print-needed"], check=True, capture_output=True, text=True).stdout.split()
    command = [*shlex.split(os.environ.get("CC", "cc")), "-std=c99", "-O1", "-Iinclude", "-Isrc", "-Itests/unit", f"-I{WORK}", "-DOPTION_CONTRACT", "-w",
               "tests/tools/option_contract.c", *program_sources(), ARCHIVE, *needed, "-o", str(program)]
    subprocess.run(command, check=True)
    return subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()


# ---- The program ----

# Commands and the structs that their options fill, in this order.
FILLED = {
    "voxelize": ["lattice", "voxelize", "field", "points", "surface", "read_volume", "keep", "simplify", "field_surface", "context"],
    "lod": ["levels", "simplify", "lod", "lattice", "voxelize", "read_volume", "keep", "context"],
    "simplify": ["simplify", "context"],
    "repair": ["repair", "simplify", "context"],
    "hull": ["hull", "context"],
    "boolean": ["boolean", "lattice", "simplify", "context"],
    "refine": ["refine", "context"],
    "sections": ["sections", "read_sections", "simplify", "context"],
    "slice": ["slice", "context"],
    "faces": ["faces", "lattice", "voxelize", "read_volume", "keep", "context"],
    "fill": ["simplify", "context"],
    "morph": ["morph", "hollow", "distance", "lattice", "voxelize", "simplify", "field_surface", "context"],
    "components": ["keep", "simplify", "context"],
    "labels": ["labels", "read_volume", "write", "context"],
    "convert": ["write", "read_volume", "keep", "context"],
    "render": ["render", "voxelize", "read_volume", "keep", "context"],
    "compare": ["context"],
    "info": ["measure", "read_volume", "context"],
    "check": ["inspect", "context"],
}
# Rows whose name is not the field's.
SYNONYMS = {
    ("faces", "--merge"): "merged", ("refine", "--halvings"): "levels", ("sections", "--subdivide"): "depth", ("lod", "--attributes"): "attribute_weight",
    ("simplify", "--attributes"): "attribute_weight",
    ("morph", "--drain"): "drain_radius", ("voxelize", "--value-type"): "value_type", ("refine", "--adaptive"): "tolerance",
    ("components", "--keep-largest"): "largest", ("voxelize", "--keep-largest"): "largest", ("lod", "--keep-largest"): "largest",
    ("faces", "--keep-largest"): "largest", ("render", "--keep-largest"): "largest", ("convert", "--keep-largest"): "largest",
}


def program(rows):
    seen = set()
    for row in rows:
        if not row.startswith("row\t"):
            continue
        _, name, command, kind, low, high, least, names, base, help = row.split("\t")
        help = help.replace("\\n", " ")
        where = f"src/cli_commands/cmd_{command}.c: {name} of {command}"
        field = SYNONYMS.get((command, name), name.strip("-").replace("-", "_"))
        targets = [STRUCTS[s][field] for s in FILLED[command] if field in STRUCTS[s]]
        if not targets or (command, name) in OWN or ("*", name) in OWN:
            if not targets and (command, name) not in OWN and ("*", name) not in OWN:
                wrong(where, "fills no field of FILLED, SYNONYMS or OWN in tests/tools/check_options.py")
            seen.add((command, name))
            seen.add(("*", name))
            continue
        compare_row(where, targets[0], kind, float(low), float(high), int(least), names.split(",") if names else [], int(base), help)
    names_exist({row.split("\t")[1] for row in rows if row.startswith("row\t")})
    for one in OWN:
        if one not in seen:
            wrong("tests/tools/option_exceptions.py", f"{one} is no option of a command")


def names_exist(known):
    """Names of options in the program's sources, as rows of rules have them: one that is misspelt would never hold."""
    for path in sorted(Path("src").glob("cli_*/*.c")):
        for text in re.findall(r'"((?: ?--[a-z][a-z-]*)+ ?)"', path.read_text()):
            for name in text.split():
                if name not in known | {"--man", "--bash-completion", "--version", "--output"}:
                    wrong(str(path), f"{name} is no option of any command")


def compare_row(where, f, kind, low, high, least, names, base, help):
    told = re.findall(r"\[([^\[\]]*)\]$", help)
    first = re.split(r"[;,:]", told[0])[0].strip() if told else None
    default = default_of(f)
    if kind in ("INT", "LONG", "REAL") and f.pieces is not None and f.pieces:
        step = 1 if kind != "REAL" else 2.0**-10
        unset = default[0] if default not in (None, "NULL") else None  # it says that nothing is given
        lowest, highest = (low, high) if kind != "REAL" or least else (low + step, high - step)
        ends = [one for one, *_ in f.pieces if one is not None], [one[2] for one in f.pieces if one[2] is not None]
        for value, sign in ((lowest, -1), (highest, 1)):
            if abs(value) < 1e15 and not f.inside(value):
                wrong(where, f"takes {value:g}, which {f.struct}.{f.name} [Limit: {f.limit}] refuses")
            if value + sign * step != unset and not (f.none and value + sign * step == -1) and f.inside(value + sign * step) and (value + sign * step >= 0 or f.type != "uint64_t") and abs(value) < 2**31 - 2 and \
                    (ends[0] if sign < 0 else ends[1]):
                wrong(where, f"refuses {value + sign * step:g}, which {f.struct}.{f.name} [Limit: {f.limit}] takes")
    if kind == "FLAG":
        return
    if first is None or default in (None, "NULL"):
        return
    value = None
    if first in names:
        value = base + names.index(first)
        if (f.struct, f.name) in BY_INDEX:
            value = BY_INDEX[f.struct, f.name](value)
    elif kind != "CHOICE":
        value = number(first)
    if value is not None and kind != "SET" and value != default[0] and (f.struct, f.name, where.split(": ")[1]) not in LATER:
        wrong(where, f"says [{first}], the header [Default: {f.default}]")


# ---- The Python package ----


def python():
    texts = {f.struct: f for f in []}
    spoken = 0
    for path in sorted(Path("bindings/python/src/bitvox").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.FunctionDef):
                continue
            kinds = [c.args[0].value.removesuffix("_options") for c in ast.walk(node) if isinstance(c, ast.Call) and getattr(c.func, "id", "") == "options_of"
                     and c.args and isinstance(c.args[0], ast.Constant)]
            if len(kinds) != 1 or kinds[0] not in STRUCTS:
                continue
            spoken += compare_function(f"{path}: {node.name}", STRUCTS[kinds[0]], node)
    if spoken < 60:
        wrong("bindings/python", f"only {spoken} defaults and ranges were compared: is the package read?")


def constant(node):
    try:
        return eval(compile(ast.Expression(node), "", "eval"), {"__builtins__": {}}, {})
    except Exception:
        return None


def compare_function(where, of, node):
    spoken = 0
    arguments = list(zip(reversed(node.args.args), reversed(node.args.defaults))) + list(zip(node.args.kwonlyargs, node.args.kw_defaults))
    told = [(argument.arg, value) for argument, value in arguments]
    # Options beyond the signature: advanced.get("samples", 2).
    told += [(c.args[0].value, c.args[1]) for c in ast.walk(node) if isinstance(c, ast.Call) and isinstance(c.func, ast.Attribute) and c.func.attr == "get"
             and getattr(c.func.value, "id", "") == "advanced" and len(c.args) == 2]
    for name, value in told:
        f = of.get(name)
        if f is None or not isinstance(value, ast.Constant) or value.value is None or default_of(f) in (None, "NULL"):
            continue
        given, said = value.value, default_of(f)[0]
        if isinstance(given, str):
            names = {text: v for rows in LISTS.values() for name, (v, text) in rows.items() if re.search(rf"BVX_{name.split('_')[1]}_", f.comment + " BVX_" + f.name.upper())}
            given = names.get(given)
        spoken += 1
        if given is not None and given != said and (where.split("/")[-1], name) not in LATER:
            wrong(where, f"{name}={value.value!r}, the header [Default: {f.default}]")
    for call in ast.walk(node):
        if not (isinstance(call, ast.Assign) and isinstance(call.value, (ast.Call, ast.IfExp)) and isinstance(call.targets[0], ast.Attribute)):
            continue
        f = of.get(call.targets[0].attr)
        for inner in ast.walk(call.value):
            if f is not None and isinstance(inner, ast.Call) and getattr(inner.func, "id", "") == "in_range" and len(inner.args) == 4 and f.pieces:
                low, high = constant(inner.args[2]), constant(inner.args[3])
                spoken += 1
                for value, sign in ((low, -1), (high, 1)):
                    if value is None or abs(value) >= 2**53:
                        continue
                    if not f.inside(value):
                        wrong(where, f"{f.name}: takes {value}, which the header's [Limit: {f.limit}] refuses")
                    elif f.none and value + sign == -1:
                        continue
                    elif any(one[0 if sign < 0 else 2] is None for one in f.pieces) or default_of(f) == [value + sign]:
                        continue
                    elif f.inside(value + sign) and abs(value) < 2**31 - 1:
                        wrong(where, f"{f.name}: refuses {value + sign}, which the header's [Limit: {f.limit}] takes")
    return spoken


rows = built()
problems += [row[6:] for row in rows if row.startswith("wrong\t")]
program(rows)
python()
for one in problems:
    print("error: " + one)
print(f"{len(fields)} fields, {sum(row.startswith('row') for row in rows)} rows; {len(problems)} disagreements")
sys.exit(1 if problems else 0)
