#!/usr/bin/env python3
"""Error against time of whitted's adaptive anti-aliasing and POV-Ray's methods 1 and 2, on the assignment scene.

    python3 benches/peers/antialiasing.py [--rounds 3] [--threads 1] [--out FOLDER]

Needs cargo, Debian's package povray, and Python's numpy and pillow. Each program's pictures are compared with its own converged one
(grids of 16 x 16 and 12 x 12 rays per pixel), because the two differ a little in what they draw; errors are root mean squares in levels of
255 of the 8-bit pictures, so that rounding adds 0.29 in quadrature to both. Rounds are interleaved, times are medians of the
programs' own trace times. Written: antialiasing.csv, antialiasing.md: for each point of POV-Ray's front, the time in which whitted
reaches the same error, by straight lines between its own points in logarithms of both.
"""
import argparse, csv, json, math, os, re, shutil, statistics, subprocess, sys, tempfile

from common import HERE, ROOT, build, folder, whole

SIDE, FINE = 600, 12
ERRORS = ['32', '24', '16', '12', '8', '6', '4', '3', '2', '1', '0.5']
THRESHOLDS = ['0.5', '0.3', '0.1', '0.05', '0.02', '0.0']

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument('--rounds', type=whole, default=3)
parser.add_argument('--threads', type=whole, default=1)
parser.add_argument('--out', type=folder, default='.', help='folder for antialiasing.csv and antialiasing.md')
options = parser.parse_args()
try:
    import numpy
    from PIL import Image
except ImportError as missing:
    parser.error({'PIL': 'pillow'}.get(missing.name, missing.name) + ' is not installed')
if not shutil.which('povray'):
    parser.error('povray is not installed')
Image.MAX_IMAGE_PIXELS = None


def run(command, **kw):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors='replace', **kw)
    if done.returncode:
        sys.exit(f'failed: {" ".join(command)}\n{done.stdout[-500:]}')
    return done.stdout.replace('\r', '\n')


def ours(program, work, mode):
    """The trace time of whitted in an anti-aliasing mode, and its picture."""
    picture = os.path.join(work, 'ours.png')
    text = run([program, 'render', 'assignment', '--aa', mode, '--threads', str(options.threads), '--quiet', '--stats', '-',
                '-o', picture])
    return json.loads(text)['seconds']['render'], picture


def povray(work, *flags, side=SIDE):
    """The trace time of POV-Ray with some flags, and its picture."""
    text = run(['povray', os.path.join(HERE, 'assignment.pov'), f'+W{side}', f'+H{side}', '-D', '-V', '+FN', '+Opovray.png', '-J',
                f'+L{os.path.join(ROOT, "textures")}', f'+WT{options.threads}', *flags], cwd=work)
    return float(re.search(r'Trace Time:[^(]*\(([\d.]+) seconds\)', text).group(1)), os.path.join(work, 'povray.png')


def levels(picture):
    return numpy.asarray(Image.open(picture).convert('RGB'), dtype=numpy.float64)


def averaged(picture):
    """A picture of `FINE` times the size, averaged in linear light and encoded again; a row of pixels at a time."""
    display = numpy.arange(256) / 255
    linear = numpy.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)
    fine = numpy.asarray(Image.open(picture).convert('RGB'))
    rows = [linear[fine[FINE * y:FINE * (y + 1)]].reshape(FINE, SIDE, FINE, 3).mean(axis=(0, 2)) for y in range(SIDE)]
    mean = numpy.array(rows)
    return 255 * numpy.where(mean <= 0.0031308, 12.92 * mean, 1.055 * mean ** (1 / 2.4) - 0.055)


def front(points):
    """The points (seconds, error, ...) that no other beats in both, from the fastest."""
    best, kept = math.inf, []
    for point in sorted(points):
        if point[1] < best:
            best = point[1]
            kept.append(point)
    return kept


def time_for(error, points):
    """The seconds in which a front reaches an error; None if it does not."""
    for (t0, e0, *_), (t1, e1, *_) in zip(points, points[1:]):
        if e1 <= error <= e0:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return t0 * (t1 / t0) ** share
    return points[0][0] if error >= points[0][1] else None


def main():
    whitted = build(parser, '--bin', 'whitted')['whitted']
    modes = [('whitted', f'adaptive:{error}') for error in ERRORS] + [('whitted', 'none')]
    modes += [('povray', f'+A{threshold} +AM{method} +R{depth}')
              for method in (1, 2) for depth in (2, 3, 4) for threshold in THRESHOLDS] + [('povray', '-A')]
    with tempfile.TemporaryDirectory(prefix='antialiasing-') as work:
        converged = {'whitted': levels(ours(whitted, work, 'grid:16')[1]),
                     'povray': averaged(povray(work, '-A', side=SIDE * FINE)[1])}
        seconds, errors = {}, {}
        for number in range(options.rounds):
            for key in modes:
                program, mode = key
                time, picture = ours(whitted, work, mode) if program == 'whitted' else povray(work, *mode.split())
                seconds.setdefault(key, []).append(time)
                if number == 0:
                    errors[key] = math.sqrt(((levels(picture) - converged[program]) ** 2).mean())
            print(f'round {number + 1} of {options.rounds}', file=sys.stderr, flush=True)
    points = {key: (statistics.median(seconds[key]), errors[key], key[1]) for key in modes}
    with open(os.path.join(options.out, 'antialiasing.csv'), 'w', newline='') as f:
        table = csv.writer(f)
        table.writerow(['program', 'mode', 'seconds', 'rmse'])
        table.writerows([*key, f'{point[0]:.4g}', f'{point[1]:.4g}'] for key, point in points.items())
    own, theirs = (front(point for key, point in points.items() if key[0] == program) for program in ('whitted', 'povray'))
    with open(os.path.join(options.out, 'antialiasing.md'), 'w') as f:
        f.write(f'Written by benches/peers/antialiasing.py: assignment, {SIDE} x {SIDE}, {options.threads} threads.\n\n')
        f.write('| POV-Ray | error, levels | POV-Ray, s | whitted for that error, s | times as fast |\n| --- | --- | --- | --- | --- |\n')
        for time, error, mode in theirs:
            ours_time = time_for(error, own)
            f.write(f'| `{mode}` | {error:.2f} | {time:.3g} | ' + (f'{ours_time:.3g} | {time / ours_time:.1f} |\n' if ours_time else '- | - |\n'))


main()
