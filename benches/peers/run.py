#!/usr/bin/env python3
"""whitted against the programs that a user would otherwise pick, side by side in one interleaved run.

    python3 benches/peers/run.py [--rounds 5] [--only REGEX] [--objects 1e3 1e4 1e5 1e6] [--out FOLDER]

Needs cargo, and for the peers Debian's packages povray, libembree-dev and g++ and Python's numpy; a peer that is not there is left
out and said. Every measurement is a process of its own; round 1 measures every task once, then comes round 2, so that a change
of the machine's mood hits all alike. The tables give medians, and ratios of medians. Written: peers.csv, peers.md, and frames.svg, which
plots the trace times of the sphere scenes for the largest of the numbers of threads.
"""
import argparse, csv, json, os, re, shutil, statistics, subprocess, sys, tempfile

import chart

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TEXTURES = os.path.join(ROOT, 'textures')
EMBREE = 'libembree3.so.3'
ADAPTIVE = 'adaptive:16'  # about the error of grid:2 on the sphere scenes

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument('--rounds', type=int, default=5)
parser.add_argument('--only', type=re.compile, default=re.compile('.'), help='tasks whose name matches')
parser.add_argument('--objects', nargs='*', default=['1e3', '1e4', '1e5', '1e6'], help='sphere counts')
parser.add_argument('--meshes', nargs='*', default=['icos:1000:3'], help='icos:N:LEVEL or obj:FILE, for the ray queries')
parser.add_argument('--threads', nargs='*', type=int, default=[1, 2])
parser.add_argument('--out', default='.', help='folder for peers.csv and peers.md')
options = parser.parse_args()
os.makedirs(options.out, exist_ok=True)  # now, not after all is measured


def run(command, **kw):
    """The output of a command, or None if it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors='replace', **kw)
    if done.returncode:
        print('failed:', ' '.join(command[:4]), done.stdout[-300:], file=sys.stderr)
        return None
    return done.stdout.replace('\r', '\n')


def ours(work, scene, mode, threads):
    command = [os.path.join(ROOT, 'target/release/whitted'), 'render', scene[0], '--threads', str(threads), '--quiet', '--stats', '-',
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
    if run(['cargo', 'build', '--release', '--example', 'raybench', '--bin', 'whitted'], cwd=ROOT) is None:
        sys.exit('whitted does not build')
    have_povray, have_embree = shutil.which('povray'), None
    if shutil.which('g++'):
        raybench = os.path.join(work, 'raybench')
        have_embree = run(['g++', '-O3', '-march=native', '-std=c++17', os.path.join(HERE, 'raybench.cpp'), '-ldl', '-o', raybench])
    for name, have in (('povray', have_povray), ('embree', have_embree)):
        if have is None:
            print(f'{name} is left out: not installed', file=sys.stderr)
    tasks = []
    for threads in options.threads:
        for rays, mode in ((1, 'none'), (4, 'grid:2')):
            group = f'assignment, {rays} rays per pixel, {threads} threads'
            tasks.append((group, 'whitted', ours(work, ['assignment'], mode, threads)))
            if have_povray:
                tasks.append((group, 'povray', povray(work, os.path.join(HERE, 'assignment.pov'), rays, threads)))
            for count in options.objects:
                group = f'spheres {count}, {rays} rays per pixel, {threads} threads'
                spheres = ['spheres', '--objects', str(int(float(count)))]
                tasks.append((group, 'whitted', ours(work, spheres, mode, threads)))
                if rays == 4:
                    group_of_adaptive = f'spheres {count}, {ADAPTIVE}, {threads} threads'
                    tasks.append((group_of_adaptive, 'whitted', ours(work, spheres, ADAPTIVE, threads)))
                if have_povray:
                    scene = os.path.join(work, f'{count}.pov')
                    tasks.append((group, 'povray', povray(work, scene, rays, threads)))
    own = os.path.join(ROOT, 'target/release/examples/raybench')
    for what in [f'spheres:{count}' for count in options.objects] + options.meshes:
        tasks.append((f'queries {what}', 'whitted', queries([own, what, '3'])))
        if have_embree is not None:
            quality = 'medium' if what.startswith('spheres') else 'medium-robust'
            tasks.append((f'queries {what}', 'embree', queries([raybench, EMBREE, what, quality, '3'])))
    tasks = [task for task in tasks if options.only.search(task[0])]
    for count in options.objects:
        if have_povray and any(f'spheres {count},' in group for group, _, _ in tasks):
            run([sys.executable, os.path.join(HERE, 'stress.py'), 'pov', count, os.path.join(work, f'{count}.pov')])
    return tasks


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
                # Our tiles of 64 rays against its packets of 16, both told that the rays are coherent.
                theirs = measure.replace('camera_coherent', 'camera_intersect16_coherent')
                a, b = median[group, program, measure], median.get((group, 'embree', theirs))
                ratio = '-' if not b else f'{a / b:.2f}' if 'Mrays' in measure else f'{b / a:.2f}'
                f.write(f'| {group.removeprefix("queries ")} | {measure} | {a:.4g} | ' + (f'{b:.4g}' if b else '-') + f' | {ratio} |\n')
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
