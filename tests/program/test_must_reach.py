"""test_must_reach.py - no solid is off and no result falls to pieces without a word.

python3 test_must_reach.py [PROGRAM [MESHES [NAME]]]

PROGRAM is build/bitvox, or what BITVOX names, MESHES is ../shared/meshes. For all meshes there, when the folder is, and some dozens
made here, of NAME alone where one is given:
    the volume of the solid at 48 and 128 lies within 1 % of the winding-number volume there, and of the true volume where it is
    known, or the program warns. Winding numbers know what is right only where triangles face out: of meshes made here they are
    those of the mesh before it was spoilt, of files they count where all edges agree and no triangle is there twice;
    the volume of what repair and lod make lies within 5 % of the true one where it is known, or the program warns;
    no mesh that repair, simplify, lod and boolean make has more parts than the input, or the program warns; simplify parts sheets that
    meet in one edge by sides, so of it this holds for manifold meshes.
Ends with "N passed, N failed, N skipped"; each failure names the mesh, what was found and what was wanted. Time is bounded by sizes:
meshes of more than LARGE triangles are only made solid, files of more than HUGE bytes and SLOW meshes are left out but with BITVOX_LARGE."""
import json, os, subprocess, sys, tempfile

sys.path.insert(0, 'tests/tools')
from made_meshes import Mesh, box, made_meshes

LARGE = 60000
HUGE = 1 << 20  # bytes of a packed file: smaller ones take the same ways, so these are left to BITVOX_LARGE=1
SLOW = ('shell_0.26_voxels', 'shell_0.45_voxels')  # half of the time of all: other walls take the same ways
program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.environ.get('BITVOX', 'build/bitvox'))
folder = os.path.abspath(sys.argv[2] if len(sys.argv) > 2 else '../shared/meshes')
only = sys.argv[3] if len(sys.argv) > 3 else None
spent_by = {}
counts = {'passed': 0, 'failed': 0, 'skipped': 0}


# ---- runs ----

def spent():
    t = os.times()
    return t.children_user + t.children_system


def run(*words):
    """The report, or None where the program refuses, which is a word too."""
    begun = spent()
    r = subprocess.run([program, *words, '--json', '--quiet'], capture_output=True, text=True)
    report = json.loads(r.stdout)
    spent_by[words[0]] = spent_by.get(words[0], 0) + spent() - begun
    if r.returncode not in (0, 1):
        raise SystemExit('%s: status %d: %s' % (' '.join(words), r.returncode, r.stderr))
    return report if report['status'] == 'done' else None


def judge(name, what, good, found):
    counts['passed' if good else 'failed'] += 1
    if not good:
        print('not ok %s: %s: %s' % (name, what, found))


def check(name, path, truth, right):
    info = run('info', path)
    if info is None:
        counts['skipped'] += 1
        return
    before = info['meshes'][0]
    parts, triangles = before['components'], before['triangles']
    if right is None and (before['flipped_edges'] == 0 and before['duplicates'] == 0 and before['volume'] > 0):
        right = path

    for at in ('48', '128'):
        solid = run('voxelize', path, '-o', 'x.bvx', '--resolution', at)
        if solid is None or solid['warnings']:
            continue
        got = solid['solid']['volume']
        wanted = []
        if right is not None:
            winding = run('voxelize', right, '-o', 'y.bvx', '--resolution', at, '--fill', 'winding')
            if winding is not None:
                wanted.append(('by winding numbers', winding['solid']['volume']))
        if truth is not None:
            wanted.append(('in truth', abs(truth)))
        for which, volume in wanted:
            judge(name, 'volume of the solid at ' + at, abs(got - volume) <= 0.01 * volume, '%g, %s %g, no warning' % (got, which, volume))
    if triangles > LARGE:
        counts['skipped'] += 1
        return

    for words in (['repair', path, '-o', 'x.ply', '--resolution', '64'], ['simplify', path, '-o', 'x.ply', '--samples', '0'],
                  ['lod', path, '-o', 'x_%d.ply', '--count', '2', '--samples', '0', '--resolution', '64'],
                  ['lod', path, '-o', 'x_%d.ply', '--levels', '48,24', '--samples', '0'],
                  ['boolean', 'union', path, 'cube.off', '-o', 'x.ply', '--resolution', '32']):
        report = run(*words)
        if report is None or report['warnings']:
            counts['passed'] += 1
            continue
        # Edges that collapse leave the volume of an open mesh undefined. The program warns from 5 % of the mesh's volume on,
        # which is up to half a percent off the truth.
        if truth is not None and words[0] in ('repair', 'lod') and len(report['meshes']) > 0:
            for m in report['meshes']:
                judge(name, ' '.join(w for w in words if w != path), abs(m['volume'] / truth - 1) <= 0.055,
                      'volume %g, in truth %g, no warning' % (m['volume'], truth))
        allowed = parts + (words[0] == 'boolean')
        for m in report['meshes'] if before['manifold'] or words[0] != 'simplify' else ():
            judge(name, ' '.join(w for w in words if w != path), m['components'] <= allowed, '%d parts of %d, no warning' % (m['components'], allowed))


def main():
    files = []
    if os.path.isdir(folder):
        files = [os.path.join(folder, f) for f in sorted(os.listdir(folder)) if os.path.isfile(os.path.join(folder, f))]
        left = [] if os.environ.get('BITVOX_LARGE') else [f for f in files if os.path.getsize(f) > HUGE]
        for f in left:
            print('# %s: skipped, BITVOX_LARGE=1 asks for it' % os.path.basename(f))
            counts['skipped'] += 1
        files = [f for f in files if f not in left]
    else:
        print('# %s is not there: made meshes alone' % folder)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        box(Mesh(), (0, 0, 0), (0.5, 0.5, 0.5)).write('cube.off')
        jobs = [(os.path.basename(f), f, None) for f in files] + list(made_meshes())
        for name, mesh, truth, *given in jobs:
            if only is not None and only != name:
                continue
            if only is None and name in SLOW and not os.environ.get('BITVOX_LARGE'):
                print('# %s: skipped, BITVOX_LARGE=1 asks for it' % name)
                counts['skipped'] += 1
                continue
            path = mesh
            if isinstance(mesh, Mesh):
                path = name + '.off'
                mesh.write(path)
            right = None
            if given:
                right = name + '_right.off'
                given[0].write(right)
            check(name, path, truth, right)
    print('# %.1f seconds of processor time: %s' % (spent(), ', '.join('%s %.1f' % e for e in spent_by.items())))
    print('%(passed)d passed, %(failed)d failed, %(skipped)d skipped' % counts)
    return counts['failed'] != 0


sys.exit(main())
