"""The package's modules stand in layers: no ring of imports, none inside functions, one table for what lies above a class."""

import ast
from pathlib import Path

import pytest

import bitvox
from bitvox import _calls

PACKAGE = Path(bitvox.__file__).parent
MODULES = {("bitvox." + path.relative_to(PACKAGE).with_suffix("").as_posix().replace("/", ".")).removesuffix(".__init__"): path
           for path in PACKAGE.rglob("*.py")}


def imported(module, node):
    """Modules of the package that a statement imports."""
    base = module.split(".") if MODULES[module].name == "__init__.py" else module.split(".")[:-1]
    if isinstance(node, ast.Import):
        return {a.name for a in node.names if a.name in MODULES}
    if node.level == 0:
        return {node.module} & set(MODULES)
    where = ".".join([*base[: len(base) - node.level + 1], *([node.module] if node.module else [])])
    names = {f"{where}.{a.name}" for a in node.names} - {"bitvox._native"}
    parts = names & set(MODULES)
    return parts | ({where} & set(MODULES) if names - parts else set())


def checked_only(node):
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)


def statements(tree):
    """All nodes that run, with the function that each stands in."""
    todo = [(node, None) for node in tree.body]
    while todo:
        node, inside = todo.pop()
        yield node, inside
        if checked_only(node):
            todo += [(child, inside) for child in node.orelse]
            continue
        function = node.name if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) else inside
        todo += [(child, function) for child in ast.iter_child_nodes(node)]


def graph():
    found = {}
    for module, path in MODULES.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found[module] = {name for node, _ in statements(tree) if isinstance(node, (ast.Import, ast.ImportFrom)) for name in imported(module, node)}
    return found


def test_no_ring_of_imports():
    left = graph()
    assert sum(map(len, left.values())) > 100
    while True:  # take away what imports nothing that is left
        free = [module for module, uses in left.items() if not uses & (set(left) - {module})]
        if not free:
            break
        for module in free:
            del left[module]
    assert left == {}


def test_imports_stand_at_the_top():
    """numpy is imported when it is needed, and what an extra brings by `need`, which imports by name."""
    inside = [f"{module}.{function}: {ast.unparse(node)}" for module, path in MODULES.items()
              for node, function in statements(ast.parse(path.read_text(encoding="utf-8")))
              if isinstance(node, (ast.Import, ast.ImportFrom)) and function]
    assert inside == ["bitvox._arrays.numpy_or_none: import numpy"]


def test_calls_are_in_the_table():
    """Every name that a class calls is entered, and every entered one is called."""
    used = set()
    for path in MODULES.values():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "call":
                name = node.args[0]
                used |= {c.value for c in ast.walk(name) if isinstance(c, ast.Constant) and isinstance(c.value, str) and not isinstance(name, ast.Compare)}
            if isinstance(node, ast.Subscript) and getattr(node.value, "id", "") == "TABLE" and isinstance(node.slice, ast.Constant):
                used.add(node.slice.value)
    used -= {"nii"}  # what one call is chosen by
    assert used == set(_calls.TABLE) | set(_calls.LATER)


def test_unknown_call():
    with pytest.raises(KeyError):
        _calls.call("no_such_call")


@pytest.mark.parametrize("name", sorted(_calls.LATER))
def test_later_calls_are_there(name):
    module = MODULES["bitvox" + _calls.LATER[name]]
    assert any(isinstance(n, ast.FunctionDef) and n.name == name for n in ast.parse(module.read_text(encoding="utf-8")).body)
