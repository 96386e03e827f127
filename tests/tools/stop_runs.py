"""stop_runs.py - runs of the program are ended by signals at random moments of their life.

python3 stop_runs.py PROGRAM FIXTURES SEED RUNS

Works in the current folder, which holds knot.csv and knot.bvx. After SIGINT, SIGTERM or SIGHUP (sometimes two): status 130 and
one line of words, or 0; all outputs hold the older bytes or all the new, and nothing else lies in the folder. After SIGKILL:
each output holds its older bytes or the whole new ones; beside them at most bitvox-PID-N.part. Before the program has
begun to watch, a signal ends it as it ends any other, and nothing has been touched. Prints what happened; status 0 when all held.
"""
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time

program, fixtures, seed, runs = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
random.seed(seed)
knot = os.path.join(fixtures, "knot.ply")
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL]
JOBS = [  # outputs, words
    ("x_0.ply x_1.ply", "lod KNOT -o stop/x_%d.ply --levels 64,32 --samples 2000"),
    ("x.npy x.npy.json", "voxelize KNOT -o stop/x.npy --resolution 200"),
    ("x.vti", "voxelize KNOT -o stop/x.vti --mode field --resolution 48"),
    ("x.bvx", "refine KNOT -o stop/x.bvx --resolution 200"),
    ("x.ply", "repair KNOT -o stop/x.ply --resolution 64"),
    ("x.bvx", "morph close KNOT -o stop/x.bvx --resolution 96 --radius 0.1"),
    ("x.ply", "boolean union KNOT KNOT -o stop/x.ply --resolution 48"),
    ("x.ply x.csv", "sections knot.csv -o stop/x.ply --block-model stop/x.csv --block 0.5,0.5,0.5"),
    ("x.csl", "slice KNOT -o stop/x.csl --spacing 0.1"),
    ("x.ply", "faces KNOT -o stop/x.ply --resolution 64"),
    ("x.bvx", "components knot.bvx -o stop/x.bvx"),
    ("x.bvx", "fill knot.bvx -o stop/x.bvx"),
    ("x.stl", "convert KNOT -o stop/x.stl"),
    ("x.png", "render KNOT -o stop/x.png --size 600x600"),
]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def start(words):
    with open("said", "wb") as out, open("words", "wb") as err:
        return subprocess.Popen([program] + words, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                preexec_fn=lambda: [signal.signal(s, signal.SIG_DFL) for s in SIGNALS[:3]])


def fresh(outputs):
    shutil.rmtree("stop", ignore_errors=True)
    os.mkdir("stop")
    older = {n: b"kept " + n.encode() for n in outputs if random.random() < 0.7}
    for n, b in older.items():
        with open("stop/" + n, "wb") as file:
            file.write(b)
    return older


def check(number, status, older, right):
    found, told = {n: read("stop/" + n) for n in os.listdir("stop")}, read("words").decode(errors="replace")
    lines = [w for w in told.splitlines() if not w.startswith("bitvox: warning: ")]
    what = (signal.Signals(number).name, status, told, sorted(found), sorted(older))
    if status == 0:
        assert found == right and not lines, what
        return "done"
    if number == signal.SIGKILL:
        assert status == -number, what
        for n, b in found.items():
            beside = re.fullmatch(r"bitvox-\d+-\d+\.part", n)
            assert beside or b == older.get(n) or b == right.get(n), what
        assert set(older) <= set(found), what
        return "killed"
    if status == -number:
        assert found == older and not told, what
        return "before it began"
    assert status == 130 and len(lines) == 1 and lines[0].startswith("bitvox: interrupted"), what
    assert found == (right if "is written" in told else older), what
    return "interrupted"


happened, rights = {}, {}
for turn in range(runs):
    names, words = JOBS[turn % len(JOBS)]
    outputs = names.split()
    words = words.replace("KNOT", knot).split() + ["--threads", str(random.choice([1, 2, 2]))]
    if names + words[0] not in rights:
        fresh([])
        before = time.monotonic()
        assert start(words).wait() == 0, read("words")
        life = time.monotonic() - before
        rights[names + words[0]] = {n: read("stop/" + n) for n in os.listdir("stop")}, life
        assert set(rights[names + words[0]][0]) == set(outputs), words
    right, life = rights[names + words[0]]
    older = fresh(outputs)
    number = random.choice(SIGNALS)
    child = start(words)
    time.sleep(random.random() * life)
    child.send_signal(number)
    if random.random() < 0.3:
        child.send_signal(number)
    end = check(number, child.wait(), older, right)
    happened[end] = happened.get(end, 0) + 1
shutil.rmtree("stop")
print("seed %d: " % seed + ", ".join("%d %s" % (happened[k], k) for k in sorted(happened)))
