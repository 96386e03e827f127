"""stack_chains.py - the deepest chain of calls by gcc's call graphs (-fcallgraph-info=su), and that none calls itself.

python3 stack_chains.py LIMIT FILE.ci...   Called by analyze.sh, in the project's folder.

A call through a pointer counts as the deepest function that it may reach: from parallel.c and those of threads all tasks, from other
rooms all functions that nobody calls by name and that are no tasks. The other pointers in src/core are a caller's allocator
and progress function, whose stack is the caller's own.
"""
import re
import sys

# Functions that come round again, and how often they stand in a chain at most.
ROUNDS = {"src/grid/cast.c:walk_cast_rows": 2}  # by bricks, and in each by voxels

limit = int(sys.argv[1])
size, place, calls, called = {}, {}, {}, set()
for path in sys.argv[2:]:
    for line in open(path):
        node = re.match(r'node: { title: "([^"]+)" label: "[^"]*\\n(src/[^":]*):(\d+):\d+\\n(\d+) bytes \(', line)
        edge = re.match(r'edge: { sourcename: "([^"]+)" targetname: "([^"]+)"', line)
        if node:
            place[node[1]], size[node[1]] = (node[2], int(node[3])), int(node[4])
        elif edge:
            calls.setdefault(edge[1], set()).add(edge[2])
            called.add(edge[2])


def is_task(name):
    file, line = place[name]
    return "(void *user, int32_t " in open(file).read().split("\n")[line - 1]


def deepest(roots, of_task, of_other):
    """The deepest chain from any of the roots, bytes and names, with those that calls through pointers go on with."""
    known = {}

    def go_on(name, caller, path):
        if name != "__indirect_call":
            return chain(name, path)
        file = place[caller][0]
        if file.startswith("src/core/"):
            return of_task if file[9:] in ("parallel.c", "openmp.c", "threads.c", "processors.c") else (0, ())
        return of_other

    def chain(name, path):
        if name in path:
            circle = path[path.index(name):]
            times = max((ROUNDS[n] for n in circle if n in ROUNDS), default=0)
            if times == 0:
                sys.exit("FAIL a circle of calls: " + " ".join(circle + (name,)))
            if path.count(name) >= times:
                return 0, ()
        if name in known:
            return known[name]
        below = max((go_on(n, name, path + (name,)) for n in calls.get(name, ())), default=(0, ()))
        found = size.get(name, 0) + below[0], (name,) + below[1]
        if not any(n in ROUNDS for n in path):
            known[name] = found
        return found

    return max((chain(r, ()) for r in roots), default=(0, ()))


nothing = (0, ())
public = [n for n in size if n.startswith("bvx_")]
by_pointer = [n for n in size if n not in called and n not in public]
tasks = [n for n in by_pointer if is_task(n)]
others = [n for n in by_pointer if n not in tasks]
other = deepest(others, nothing, deepest(others, nothing, nothing))
task = deepest(tasks, nothing, other)
failed = False
for what, (used, names) in (("a task", task), ("a public function", deepest(public, task, other))):
    print(f"the deepest chain of {what} takes {used} bytes of {limit}: " + " > ".join(f"{n.split(':')[-1]} {size.get(n, 0)}" for n in names))
    failed = failed or used > limit
sys.exit(failed)
