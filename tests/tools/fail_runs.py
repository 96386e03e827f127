"""fail_runs.py - every call to the system that a run of the program makes is made to fail, one after the other.

python3 fail_runs.py FAIL_CALLS PROGRAM [all]    all: each job with each fault, some minutes

Works in the current folder, which holds small.ply, small.ply.gz, small.bvx, large.xyz (more than the first MiB that is read of
a pipe, in lines) and knot.csv. A right run shows what a job is to write. Then call n fails, alone or with all of its kind that
follow, for every n that there is. After each: status 0 and the right bytes, or status 1, one line of words and every older
output as it was (where standard output failed at last, all new; where a rename fails, those before it); nothing else lies in the
folder. Parts and calls that a signal cut short must not fail at all. Signals: status 130, one line, all outputs older or all new; SIGKILL: each
older or new, and beside them at most what the manual names. Prints "ok ..." or "not ok ..." for each job and fault.
"""
import os
import shutil
import subprocess
import sys

fail_calls, program = sys.argv[1:3]
FOLDER = "faults"

# name: outputs, standard input, words
JOBS = {
    "lod": (["x_0.ply", "x_1.ply", "x_2.ply"], None, "lod small.ply -o faults/x_%d.ply --levels 8,6,4 --samples 0 --threads 1"),
    "voxelize": (["x.npy", "x.npy.json"], None, "voxelize small.ply.gz -o faults/x.npy --resolution 20 --threads 2"),
    "convert": (["x.stl"], None, "convert small.ply -o faults/x.stl --quiet"),
    "fill": (["x.bvx"], None, "fill small.bvx -o faults/x.bvx --json"),
    "sections": (["x.ply", "x.csv"], None, "sections knot.csv -o faults/x.ply --block-model faults/x.csv --block 1,1,1"),
    "cloud": (["x.bvx"], "large.xyz", "voxelize - --format xyz -o faults/x.bvx --spacing 0.5 --quiet"),
}

FAULTS = [  # call, way, often, jobs of the quick run
    ("read", "EIO", "once", "voxelize cloud"),
    ("read", "EINTR", "once", "voxelize cloud"),
    ("read", "short", "ever", "lod voxelize cloud"),
    ("write", "ENOSPC", "once", "lod voxelize fill sections"),
    ("write", "ENOSPC", "ever", "lod fill"),
    ("write", "EIO", "once", "lod"),
    ("write", "EINTR", "once", "convert fill"),
    ("write", "EAGAIN", "once", "fill"),
    ("write", "short", "once", "fill"),
    ("write", "short", "ever", "lod voxelize"),
    ("open", "EMFILE", "once", "lod"),
    ("open", "EACCES", "ever", "convert"),
    ("close", "EIO", "once", "lod voxelize"),
    ("close", "EIO", "ever", "fill"),
    ("rename", "EIO", "once", "lod voxelize convert"),
    ("rename", "EROFS", "ever", "lod"),
    ("look", "EIO", "once", "convert"),
    ("memory", "ENOMEM", "once", "voxelize"),
    ("memory", "ENOMEM", "ever", "lod"),
    ("thread", "EAGAIN", "once", "voxelize"),
    ("thread", "EAGAIN", "ever", "convert"),
    ("rename", "SIGKILL", "once", "lod convert"),
    ("write", "SIGKILL", "once", "voxelize"),
    ("rename", "SIGINT", "once", "lod"),
    ("write", "SIGINT", "ever", "voxelize"),
    ("open", "SIGTERM", "once", "convert"),
    ("close", "SIGINT", "once", ""),
    ("read", "SIGTERM", "once", ""),
]


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Runs:
    """A job under one fault."""

    def __init__(self, job, call, way, often):
        self.outputs, self.stdin, words = JOBS[job]
        self.words = words.split()
        self.call, self.way, self.often = call, way, often
        self.older = {n: b"kept " + n.encode() for i, n in enumerate(self.outputs) if i % 3 != 1}  # of three, the second is new

    def run(self, before):
        shutil.rmtree(FOLDER, ignore_errors=True)
        os.mkdir(FOLDER)
        for n, b in self.older.items():
            with open(os.path.join(FOLDER, n), "wb") as file:
                file.write(b)
        with open("said", "wb") as out, open("words", "wb") as err, open(self.stdin or os.devnull, "rb") as stdin:
            status = subprocess.call(before + [program] + self.words, stdin=stdin, stdout=out, stderr=err)
        self.told = read("words").decode(errors="replace")
        self.lines = [w for w in self.told.splitlines() if not w.startswith("bitvox: warning: ")]
        self.found = {n: read(os.path.join(FOLDER, n)) for n in os.listdir(FOLDER)}
        return status

    def wrong_after_kill(self):
        for n, b in self.found.items():
            if not (n.endswith(".part") or b == self.right.get(n) or b == self.older.get(n)):
                return "a half file or another name: %s" % n
        return None if set(self.older) <= set(self.found) else "an older file is gone"

    def wrong_after_signal(self, status):
        if status == 130 and (len(self.lines) != 1 or not self.lines[0].startswith("bitvox: interrupted")):
            return "not one line of words"
        new = status == 0 or "is written" in self.told
        return None if self.found == (self.right if new else self.older) else "outputs are not as they must be"

    def wrong_after_failure(self):
        if self.way == "short" or (self.way == "EINTR" and self.call != "open" and "standard output" not in self.told):
            return "a call that is cut short fails"
        if len(self.lines) != 1 or not self.lines[0].startswith("bitvox: "):
            return "not one line of words"
        if self.found == self.older or (self.found == self.right and "standard output" in self.told):
            return None
        for k in range(1, len(self.outputs)):  # those before the one that gets no name
            before = {n: self.right[n] for n in self.outputs[:k]}
            after = {n: b for n, b in self.older.items() if n not in before}
            if self.call == "rename" and self.found == {**before, **after} and "outputs before it are written" in self.told:
                return None
        return "outputs are not as before"

    def wrong(self, status):
        if self.way == "SIGKILL" and status == 137:
            return self.wrong_after_kill()
        if self.way.startswith("SIG") and status in (0, 130):
            return self.wrong_after_signal(status)
        if status not in (0, 1):
            return "exit status"
        if status == 1:
            return self.wrong_after_failure()
        if self.found != self.right:
            return "other bytes or names"
        return "status 0 with words" if self.lines else None

    def all(self):
        status = self.run([])
        self.right = self.found
        assert status == 0 and not self.lines and set(self.right) == set(self.outputs), (status, self.told, sorted(self.right))
        failed, bad = 0, []
        for n in range(1, 400):
            status = self.run([fail_calls, "seen", self.call, self.way, str(n), "0" if self.often == "ever" else str(n)])
            what = self.wrong(status)
            failed += status != 0
            if what:
                bad.append("call %d: %s: status %d, '%s', %s" % (n, what, status, self.told.strip(), sorted(self.found)))
            if int(read("seen")) < n or (self.way == "short" and self.often == "ever"):
                return n, failed, bad
        return n, failed, bad + ["no run passed"]


runs = 0
for call, way, often, quick in FAULTS:
    for job in JOBS if sys.argv[3:] == ["all"] else quick.split():
        n, failed, bad = Runs(job, call, way, often).all()
        runs += n
        mark = "not ok" if bad else "ok"
        print("%s %s: every %s gets %s, %s (%d runs, %d without success)" % (mark, job, call, way, often, n, failed))
        for b in bad:
            print("# " + b)
shutil.rmtree(FOLDER)
print("# %d runs" % runs)
