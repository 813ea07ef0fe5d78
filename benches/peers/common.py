"""What the comparisons share: the values that their flags may have, and the programs that cargo builds."""
import argparse, json, os, re, shutil, subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
MOST_OBJECTS = 50_000_000


def whole(text):
    """A whole number from 1."""
    if not re.fullmatch('0*[1-9][0-9]{0,3}', text):
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 to 9999")
    return int(text)


def objects(text):
    """A number of spheres as all the programs read it: digits, or digits and a power of ten."""
    if not re.fullmatch('[0-9]{1,8}(e[0-9])?', text) or not 1 <= float(text) <= MOST_OBJECTS:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 to {MOST_OBJECTS}, such as 1000 or 1e3")
    return text


def mesh(text):
    """icos:N:LEVEL, or obj:FILE with a file that is there."""
    kind, _, rest = text.partition(':')
    if kind == 'obj' and os.path.isfile(rest) or re.fullmatch('icos:[1-9][0-9]*:[0-9]', text):
        return text
    raise argparse.ArgumentTypeError(f"'{text}' is neither icos:N:LEVEL, such as icos:1000:3, nor obj:FILE with a file that is there")


def pattern(text):
    try:
        return re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"'{text}' is not a regular expression: {error}")


def folder(text):
    """A folder to write to; made now, not after all is measured."""
    try:
        os.makedirs(text, exist_ok=True)
    except OSError as error:
        raise argparse.ArgumentTypeError(f"'{text}' cannot be made: {error.strerror}")
    return text


def build(parser, *targets):
    """Has cargo build targets, and tells the path of each program by its name."""
    if not shutil.which('cargo'):
        parser.error('cargo is not installed')
    command = ['cargo', 'build', '--release', '--message-format', 'json-render-diagnostics', *targets]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit('whitted does not build')
    messages = [json.loads(line) for line in done.stdout.splitlines()]
    return {message['target']['name']: message['executable'] for message in messages if message.get('executable')}
