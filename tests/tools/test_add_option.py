"""test_add_option.py - CONTRIBUTING.md's "Add an option", step by step: what it says is done to a copy of the tree, which is built and run.

python3 tests/tools/test_add_option.py

CC is the compiler [cc], BUILD the folder of the build [build], whose Python environment builds the package where there is one. Each ```diff
block names a file and holds lines that stay, go (-) and come (+); those that stay and go must stand in the file exactly once. Ends with
"N passed, N failed, N skipped"."""
import os, re, shutil, subprocess, sys, tempfile

TOP = os.getcwd()
CC = os.environ.get('CC', 'cc')
counts = {'passed': 0, 'failed': 0, 'skipped': 0}

PROGRAM_IN_C = r'''
#include "bitvox.h"
#include <stdio.h>
int main(void)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {2, 2, 2};
    bvx_context *ctx;
    bvx_lattice lattice;
    bvx_grid grid = {0};
    bvx_faces_options o = {.struct_size = sizeof o};
    double volume[2];

    bvx_context_create(NULL, &ctx);
    bvx_lattice_make(ctx, origin, spacing, dims, &lattice);
    bvx_grid_create(ctx, &lattice, NULL, &grid);
    bvx_grid_set(&grid, 0, 0, 0, 1);
    for (o.inward = 0; o.inward < 2; o.inward++) {
        bvx_mesh mesh = {0};
        bvx_mesh_view view;
        bvx_certificate c;
        if (bvx_extract_faces(ctx, &grid, &o, &mesh) != BVX_OK) return 1;
        bvx_mesh_view_of(&mesh, &view);
        bvx_mesh_check(ctx, &view, 0, &c);
        volume[o.inward] = c.volume;
        bvx_mesh_free(ctx, &mesh);
    }
    bvx_mesh mesh = {0};
    o.inward = 2; /* is no switch */
    int const status = bvx_extract_faces(ctx, &grid, &o, &mesh);
    printf("%g %g %d %d\n", volume[0], volume[1], status, (int)bvx_last_error(ctx)->reason);
    bvx_grid_free(ctx, &grid);
    bvx_context_destroy(ctx);
    return 0;
}
'''


def check(name, good, shown=''):
    counts['passed' if good else 'failed'] += 1
    if not good:
        print(f'FAIL  {name}: {shown}')
    return good


def skip(name, why):
    counts['skipped'] += 1
    print(f'skip  {name}: {why}')


def run(*words, **more):
    done = subprocess.run(words, capture_output=True, text=True, **more)
    return done.returncode, done.stdout, done.stderr


# ---- the steps ----

def blocks():
    """(file, old text, new text) of each block of the section, in order."""
    section = open('CONTRIBUTING.md', encoding='utf-8').read().split('\n## Add an option')[1].split('\n## ')[0]
    for indent, body in re.findall(r'^( *)```diff\n(.*?)^\1```', section, re.M | re.S):
        lines = [line[len(indent):] for line in body.splitlines()]
        name = lines[0].removeprefix('--- ')
        old = ''.join(line[1:] + '\n' for line in lines[1:] if line[:1] != '+')
        new = ''.join(line[1:] + '\n' for line in lines[1:] if line[:1] != '-')
        yield name, old, new


def follow(tree):
    for name, old, new in blocks():
        path = os.path.join(tree, name)
        text = open(path, encoding='utf-8').read()
        if check(f'{name}: what the step says stands there once', text.count(old) == 1, f'{text.count(old)} times:\n{old}'):
            open(path, 'w', encoding='utf-8').write(text.replace(old, new))


# ---- what came of it ----

def check_c(tree, folder, needed):
    source, program = os.path.join(tree, 'inward.c'), os.path.join(tree, 'inward')
    open(source, 'w').write(PROGRAM_IN_C)
    status, out, err = run(*CC.split(), '-std=c99', '-I', os.path.join(tree, 'include'), source, os.path.join(folder, 'libbitvox.a'), *needed,
                           '-o', program)
    if check('a program in C compiles', status == 0, err):
        # BVX_ERR_ARGUMENT, BVX_REASON_CHOICE or _RANGE
        found = run(program)[1].split()
        check('C: the volume of inward faces is below 0, and 2 is refused',
              found[:3] == ['1', '-1', '1'] and found[3] in ('5', '19'), found)


def check_calls(tree, folder, make, clean):
    unity = os.environ.get('UNITY_DIR', os.path.join(os.environ.get('BUILD', 'build'), 'unity'))
    if not os.path.isdir(unity):
        skip('tests/unit/test_calls', f'{unity} is missing')
        return
    test = os.path.join(folder, 'tests/unit/test_calls')
    status, out, err = run(*make, f'UNITY_DIR={os.path.abspath(unity)}', test, cwd=tree, env=clean)
    if check('tests/unit/test_calls builds', status == 0, (out + err)[-2000:]):
        status, out, err = run(test, cwd=tree, env={**clean, 'BVX_QUICK': '1'})
        check('tests/unit/test_calls: wrong values are refused', status == 0, out[-2000:])


def check_program(tree, folder):
    program = os.path.join(folder, 'bitvox')
    box = os.path.join(tree, 'box.ply')
    shutil.copy(os.path.join(TOP, 'fixtures/knot.ply'), box)
    volumes = []
    for more in ([], ['--inward']):
        status, out, err = run(program, 'faces', box, '-o', os.path.join(tree, 'faces.ply'), '--resolution', '16', '--json', *more)
        volumes.append(float(re.search(r'"volume": ([-0-9.e+]+)', out)[1]) if status == 0 else err)
    check('program: --inward turns the sign of the volume', volumes[0] == -volumes[1] and volumes[0] > 0, volumes)
    for words, place in ((['faces', '--help-all'], 'help'), (['help', '--man'], 'man page'), (['help', '--bash-completion'], 'completion')):
        text = run(program, *words)[1].replace('\\-', '-')
        check(f'program: the {place} tells of --inward', '--inward' in text)
    status, _, err = run(program, 'info', box, '--inward')
    check('program: other commands refuse it', status == 2 and 'info has no use for --inward' in err, err)


def check_options(tree, folder):
    work = os.path.join(tree, 'work')
    os.makedirs(work, exist_ok=True)
    status, out, err = run(sys.executable, 'tests/tools/check_options.py', work, os.path.join(folder, 'libbitvox.a'), cwd=tree,
                           env={**os.environ, 'CC': CC})
    check('check_options.py finds header, tables, program and Python agreeing', status == 0, out + err)


def python_with_tools():
    for python in (os.environ.get('OPTION_PYTHON', ''), os.path.join(os.environ.get('BUILD', 'build'), 'python/venv/bin/python'), sys.executable):
        if python and run('sh', '-c', f"'{python}' -c 'import cffi, pcpp, setuptools, sys; sys.exit(int(setuptools.__version__.split(\".\")[0]) < 77)'")[0] == 0:
            return os.path.abspath(python)
    return None


def check_python(tree):
    python = python_with_tools()
    if python is None:
        skip('Python', 'no Python here has cffi, pcpp and setuptools 77')
        return
    package = os.path.join(tree, 'bindings/python')
    status, out, err = run(python, 'setup.py', '--quiet', 'build_ext', '--inplace', cwd=package, env={**os.environ, 'CC': CC, 'CFLAGS': '-O0', 'BITVOX_COMMAND': '0'})  # the program was looked at above
    if not check('the Python package builds', status == 0, err[-2000:]):
        return
    ask = ('import bitvox; g = bitvox.voxelize(([[0.,0,0],[1,0,0],[0,1,0],[0,0,1]], [[0,2,1],[0,1,3],[1,2,3],[2,0,3]]), resolution=8); '
           'print(bitvox.check(bitvox.faces(g)).volume == -bitvox.check(bitvox.faces(g, inward=True)).volume, "inward" in bitvox.faces.__doc__)')
    status, out, err = run(python, '-c', ask, cwd=tree, env={**os.environ, 'PYTHONPATH': os.path.join(package, 'src')})
    check('Python: inward=True turns the sign of the volume', out.split() == ['True', 'True'], out + err)


def take_objects(tree, folder):
    """Objects of the tree that the tests were built from: what no step touches is not compiled again. The header's change
    moves no field but those behind the options, so only what names them, or includes what does, reads it anew."""
    built = os.path.join(os.environ.get('BUILD', 'build'), os.path.basename(folder))
    if not os.path.isfile(os.path.join(built, 'libbitvox.a')):
        return
    shutil.copytree(built, folder, ignore=shutil.ignore_patterns('bitvox', 'test_*', 'golden', 'fuzz', 'fault', 'bench', '*.so'))
    header = 'include/bitvox.h'
    shutil.copystat(header, os.path.join(tree, header))
    for place, _, names in os.walk(os.path.join(tree, 'src')):
        for path in (os.path.join(place, name) for name in names):
            text = open(path, encoding='utf-8', errors='replace').read()
            if 'faces_options' in text or '"surface/faces.h"' in text:
                os.utime(path)


def main():
    with tempfile.TemporaryDirectory() as tree:
        for folder in ('include', 'src', 'bindings/python', 'tests/tools', 'tests/unit', 'docs'):
            shutil.copytree(folder, os.path.join(tree, folder), ignore=shutil.ignore_patterns('build', '*.so', '*.egg-info', '__pycache__', 'csrc'))
        for name in ('Makefile', 'LICENSE', 'CHANGELOG.md', 'README.md', 'CONTRIBUTING.md'):
            shutil.copy(name, tree)
        follow(tree)
        build = os.path.join(tree, 'build')
        make = [os.environ.get('MAKE_COMMAND', 'make'), '-s', f'-j{os.cpu_count() or 1}', f'BUILD={build}', f'CC={CC}']
        clean = {k: v for k, v in os.environ.items() if k not in ('MAKEFLAGS', 'MFLAGS', 'MAKELEVEL', 'MAKEOVERRIDES', 'BITVOX', 'BUILD')}
        folder = run(*make, 'print-folder', cwd=tree, env=clean)[1].strip()
        folder = folder if os.path.isabs(folder) else os.path.join(tree, folder)
        take_objects(tree, folder)
        status, out, err = run(*make, 'library', 'program', cwd=tree, env=clean)
        if check('the tree builds', status == 0, (out + err)[-2000:]):
            check_c(tree, folder, run(*make, 'print-needed', cwd=tree, env=clean)[1].split())
            check_calls(tree, folder, make, clean)
            check_program(tree, folder)
            check_options(tree, folder)
            check_python(tree)
    print(', '.join(f'{n} {what}' for what, n in counts.items()))
    sys.exit(counts['failed'] != 0)


main()
