"""A plot of lines on logarithmic axes, as SVG."""
import math

COLORS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#787878']
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 900, 520, 80, 660, 40, 460


def axis(values, start, end):
    """Where a number stands on the axis, and the powers of ten to mark."""
    low, high = math.log10(min(values)) - 0.1, math.log10(max(values)) + 0.1
    powers = range(math.ceil(low), math.floor(high) + 1)
    return lambda x: start + (end - start) * (math.log10(x) - low) / (high - low), [10.0 ** power for power in powers]


def write(path, title, x_name, y_name, lines):
    """Writes a plot of `lines`, a list of points for each name."""
    points = [point for line in lines.values() for point in line]
    x, x_ticks = axis([p[0] for p in points], LEFT, RIGHT)
    y, y_ticks = axis([p[1] for p in points], BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="14">',
           '<rect width="100%" height="100%" fill="white"/>', f'<text x="{LEFT}" y="22">{title}</text>']

    def line(places, color, width):
        path = ' '.join(f'{a:.1f},{b:.1f}' for a, b in places)
        out.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width}"/>')

    def text(a, b, what, anchor):
        out.append(f'<text x="{a:.1f}" y="{b:.1f}" text-anchor="{anchor}">{what}</text>')

    for tick in x_ticks:
        line([(x(tick), TOP), (x(tick), BOTTOM)], '#e1e1e1', 1)
        text(x(tick), BOTTOM + 20, f'{tick:g}', 'middle')
    for tick in y_ticks:
        line([(LEFT, y(tick)), (RIGHT, y(tick))], '#e1e1e1', 1)
        text(LEFT - 8, y(tick) + 5, f'{tick:g}', 'end')
    text((LEFT + RIGHT) / 2, HEIGHT - 14, x_name, 'middle')
    out.append(f'<text transform="translate(24 {(TOP + BOTTOM) / 2}) rotate(-90)" text-anchor="middle">{y_name}</text>')
    for (name, line_points), color, row in zip(lines.items(), COLORS, range(len(lines))):
        places = [(x(a), y(b)) for a, b in line_points]
        line(places, color, 2)
        out.extend(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="4" fill="{color}"/>' for a, b in places)
        out.append(f'<circle cx="{RIGHT + 16}" cy="{TOP + 6 + 22 * row}" r="4" fill="{color}"/>')
        text(RIGHT + 26, TOP + 11 + 22 * row, name, 'start')
    with open(path, 'w') as f:
        f.write('\n'.join([*out, '</svg>', '']))
