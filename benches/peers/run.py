#!/usr/bin/env python3
"""whitted against the programs that a user would otherwise pick, side by side in one interleaved run.

    python3 benches/peers/run.py [--rounds 5] [--only REGEX] [--objects 1e3 1e4 1e5 1e6] [--out FOLDER]

Needs cargo, and for the peers Debian's packages povray, libembree-dev and g++ and Python's numpy; a peer that is not there is left
out and said. Every measurement is a process of its own; round 1 measures every task once, then comes round 2, so that a change
of the machine's mood hits all alike. The tables give medians, and ratios of medians, and say where whitted and Embree differ in how many
of the same rays hit. Written: peers.csv, peers.md, and frames.svg, which plots the trace times of the sphere scenes for the largest of
the numbers of threads.
"""
import argparse, csv, importlib.util, json, os, re, shutil, statistics, subprocess, sys, tempfile

import chart
from common import HERE, ROOT, build, folder, mesh, objects, pattern, whole

TEXTURES = os.path.join(ROOT, 'textures')
EMBREE = 'libembree3.so.3'
ADAPTIVE = 'adaptive:16'  # about the error of grid:2 on the sphere scenes

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument('--rounds', type=whole, default=5)
parser.add_argument('--only', type=pattern, default='.', help='tasks whose name matches', metavar='REGEX')
parser.add_argument('--objects', nargs='*', type=objects, default=['1e3', '1e4', '1e5', '1e6'], help='sphere counts', metavar='N')
parser.add_argument('--meshes', nargs='*', type=mesh, default=['icos:1000:3'], help='icos:N:LEVEL or obj:FILE, for the ray queries')
parser.add_argument('--threads', nargs='+', type=whole, default=[1, 2], metavar='N')
parser.add_argument('--out', type=folder, default='.', help='folder for peers.csv, peers.md and frames.svg')
options = parser.parse_args()


def run(command, **kw):
    """The output of a command, or None if it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors='replace', **kw)
    if done.returncode:
        print('failed:', ' '.join(command[:4]), done.stdout[-300:], file=sys.stderr)
        return None
    return done.stdout.replace('\r', '\n')


def ours(program, work, scene, mode, threads):
    command = [program, 'render', scene[0], '--threads', str(threads), '--quiet', '--stats', '-',
               '--aa', mode, '--output', os.path.join(work, 'ours.png'), *scene[1:]]

    def measure():
        text = run(command)
        if text is None:
            return {}
        stats = json.loads(text)
        seconds = stats['seconds']
        return {'trace': seconds['render'], 'build': seconds['build'], 'process': seconds['total'],
                'MB': stats['peak_memory_bytes'] / 1e6,
                'rays': sum(stats['rays'][k] for k in ('camera', 'reflected', 'refracted', 'transmitted')),
                'shadow': stats['rays']['shadow']}
    return measure


def povray(work, scene, rays, threads):
    # Four rays per pixel are those of a picture of twice the size: POV-Ray's own anti-aliasing would trace a fifth.
    size = {1: '600', 4: '1200'}[rays]
    command = ['povray', scene, f'+W{size}', f'+H{size}', '-A', '-D', '-V', '-F', f'+L{TEXTURES}', f'+WT{threads}']

    def measure():
        text = run(command, cwd=work)
        if text is None:
            return {}
        row = {}
        for key, label in (('parse', 'Parse Time'), ('build', 'Bounding Time'), ('trace', 'Trace Time')):
            found = re.search(label + r':[^(]*\(([\d.]+) seconds\)', text)
            if found:
                row[key] = float(found.group(1))
        for key, label in (('rays', r'Rays:'), ('shadow', 'Shadow Ray Tests:')):
            found = re.search(label + r'\s+(\d+)', text)
            if found:
                row[key] = float(found.group(1))
        return row
    return measure


def queries(command):
    def measure():
        text = run(command)
        row = {}
        for line in (text or '').splitlines():
            cells = line.split(',')
            if len(cells) == 9:
                row[f'{cells[3]} [{cells[5]}]'] = float(cells[4])
                row[f'hits {cells[3]}'] = float(cells[6])
        return row
    return measure


def prepare(work):
    """The tasks as (group, program, measure), the first program of a group being ours."""
    built = build(parser, '--example', 'raybench', '--bin', 'whitted')
    have_povray, have_embree = shutil.which('povray') is not None, False
    have_spheres = have_povray and importlib.util.find_spec('numpy') is not None
    if shutil.which('g++'):
        raybench = os.path.join(work, 'raybench')
        command = ['g++', '-O3', '-march=native', '-std=c++17', os.path.join(HERE, 'raybench.cpp'), '-ldl', '-o', raybench]
        have_embree = run(command) is not None
    for name, have in (('povray', have_povray), ('embree', have_embree)):
        if not have:
            print(f'{name} is left out: not installed', file=sys.stderr)
    if have_povray and not have_spheres:
        print('the sphere scenes of povray are left out: numpy, which writes them, is not installed', file=sys.stderr)
    tasks = []
    for threads in options.threads:
        for rays, mode in ((1, 'none'), (4, 'grid:2')):
            def add_ours(group, scene, mode):
                tasks.append((group, 'whitted', ours(built['whitted'], work, scene, mode, threads)))

            def add_povray(group, scene):
                tasks.append((group, 'povray', povray(work, scene, rays, threads)))

            group = f'assignment, {rays} rays per pixel, {threads} threads'
            add_ours(group, ['assignment'], mode)
            if have_povray:
                add_povray(group, os.path.join(HERE, 'assignment.pov'))
            for count in options.objects:
                group = f'spheres {count}, {rays} rays per pixel, {threads} threads'
                spheres = ['spheres', '--objects', str(int(float(count)))]
                add_ours(group, spheres, mode)
                if rays == 4:
                    add_ours(f'spheres {count}, {ADAPTIVE}, {threads} threads', spheres, ADAPTIVE)
                if have_spheres:
                    add_povray(group, os.path.join(work, f'{count}.pov'))
    for what in [f'spheres:{count}' for count in options.objects] + options.meshes:
        tasks.append((f'queries {what}', 'whitted', queries([built['raybench'], what, '3'])))
        if have_embree:
            quality = 'medium' if what.startswith('spheres') else 'medium-robust'
            tasks.append((f'queries {what}', 'embree', queries([raybench, EMBREE, what, quality, '3'])))
    groups = dict.fromkeys(group for group, _, _ in tasks)
    tasks = [task for task in tasks if options.only.search(task[0])]
    if not tasks:
        parser.error(f"argument --only: '{options.only.pattern}' matches none of\n  " + '\n  '.join(groups))
    for count in options.objects:
        if any(group.startswith(f'spheres {count},') and program == 'povray' for group, program, _ in tasks):
            command = [sys.executable, os.path.join(HERE, 'stress.py'), 'pov', count, os.path.join(work, f'{count}.pov')]
            if run(command) is None:
                sys.exit(f'the scene of {count} spheres cannot be written for povray')
    return tasks


def theirs(measure):
    """What Embree calls a measure: our tiles of 64 rays against its packets of 16, both told that the rays are coherent."""
    return measure.replace('camera_coherent', 'camera_intersect16_coherent')


def differing_hits(median):
    """A line for each kind of rays of which one in 100,000 or more hits with one program only, although the rays are the same."""
    for (group, program, measure), ours in median.items():
        others = median.get((group, 'embree', theirs(measure)))
        if program != 'whitted' or not measure.startswith('hits ') or others is None:
            continue
        what = measure.removeprefix('hits ')
        # Shadow rays start at the camera's hits; a build hits all primitives.
        of_camera = median.get((group, 'whitted', 'hits camera_intersect1'), 0)
        rays = 360_000 if 'camera' in what else of_camera if 'shadow' in what else 1_000_000 if 'random' in what else 0
        if abs(ours - others) > 1e-5 * rays:
            place, of = group.removeprefix('queries '), f' of {rays:,.0f}' if rays else ''
            yield f'Hits differ: {place}, {what}: whitted {ours:,.0f}, Embree {others:,.0f}{of}.'


def write(rows):
    median = {key: statistics.median(values) for key, values in rows.items()}
    with open(os.path.join(options.out, 'peers.csv'), 'w', newline='') as f:
        table = csv.writer(f)
        table.writerow(['group', 'program', 'measure', 'runs', 'median', 'best'])
        for (group, program, measure), values in rows.items():
            best = max(values) if 'Mrays' in measure else min(values)
            table.writerow([group, program, measure, len(values), f'{median[group, program, measure]:.6g}', f'{best:.6g}'])
    with open(os.path.join(options.out, 'peers.md'), 'w') as f:
        f.write('Medians of interleaved rounds; written by benches/peers/run.py.\n\n')
        f.write('| picture | whitted, trace s | POV-Ray, trace s | times as fast |\n| --- | --- | --- | --- |\n')
        for group in dict.fromkeys(group for group, _, _ in rows):
            a, b = (median.get((group, program, 'trace')) for program in ('whitted', 'povray'))
            if a:
                f.write(f'| {group} | {a:.4g} | ' + (f'{b:.4g} | {b / a:.1f} |\n' if b else '- | - |\n'))
        f.write('\n| ray queries, one thread | measure | whitted | Embree | ratio |\n| --- | --- | --- | --- | --- |\n')
        for group, program, measure in rows:
            if program == 'whitted' and '[' in measure:
                a, b = median[group, program, measure], median.get((group, 'embree', theirs(measure)))
                ratio = '-' if not b else f'{a / b:.2f}' if 'Mrays' in measure else f'{b / a:.2f}'
                f.write(f'| {group.removeprefix("queries ")} | {measure} | {a:.4g} | ' + (f'{b:.4g}' if b else '-') + f' | {ratio} |\n')
        f.writelines(f'\n{line}\n' for line in differing_hits(median))
    frames = {}
    for (group, program, measure), value in median.items():
        found = re.fullmatch(rf'spheres (\S+), (.*), {max(options.threads)} threads', group)
        if found and measure == 'trace':
            name = {'whitted': 'whitted', 'povray': 'POV-Ray'}[program]
            frames.setdefault(f'{name}, {found[2].replace("1 rays", "1 ray")}', []).append((float(found[1]), value))
    if frames:
        chart.write(os.path.join(options.out, 'frames.svg'), f'Frame time of the sphere scenes, 600 x 600, {max(options.threads)} threads',
                    'spheres', 'seconds', {name: sorted(points) for name, points in frames.items()})


def main():
    with tempfile.TemporaryDirectory(prefix='peers-') as work:
        tasks, rows = prepare(work), {}
        for number in range(options.rounds):
            for group, program, measure in tasks:
                for key, value in measure().items():
                    rows.setdefault((group, program, key), []).append(value)
                print(f'round {number + 1} of {options.rounds}: {group}, {program}', file=sys.stderr, flush=True)
            write(rows)


main()
