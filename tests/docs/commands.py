"""Runs the commands of the docs: those in code blocks, and those in running text and tables that are complete. Pictures
are small and have few samples: by a configuration file, and by changed values of the options that CAPS lists.

commands.py PROGRAM [PAGE...]: the pages are paths in the repository, by default all of PAGES."""
import concurrent.futures
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

import inputs

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ["README.md", "CONTRIBUTING.md", "docs/**/*.md", "effects/*/README.md", "reference/README.md"]
TIMEOUT_S = 120

CONFIG = """resolution = 128,96
[compare]
samples = 2
runs = 1
cameras = 1
[tune]
samples = 2
runs = 1
cameras = 1
trials = 2
[bench]
runs = 1
[figures]
runs = 1
size = 128
[thumbnails]
size = 48
"""

# Values that make a command slow -> values that take the same path faster.
CAPS = [
    (r"(--resolution[ =])\d{3,}([x,])\d{3,}", r"\g<1>128\g<2>96"),
    (r"(--resolution[ =])\d{3,}(?![\dx,])", r"\g<1>64"),
    (r"^((?!umbrage tune).*--time[ =])[\d.]+", r"\g<1>0.1"),
    (r"(--samples[ =])\d+", r"\g<1>2"),
    (r"(--runs[ =])\d+", r"\g<1>1"),
    (r"(--trials[ =])\d+", r"\g<1>2"),
    (r"(--cameras[ =])\d+", r"\g<1>1"),
    (r"(--turntable[ =])(?:[5-9]|\d\d+)", r"\g<1>2"),
    (r"(--anti-aliasing[ =])\d{2,}", r"\g<1>2"),
    (r"(--size[ =])\d{3,}", r"\g<1>128"),
    (r"(--set \w+\.samples=)\d+", r"\g<1>4"),
    (r"(--frames[ =])\d+-\d\d+", r"\g<1>1-2"),
    (r"(scene:\w+)(?:\?detail=\d+)?", r'"\g<1>?detail=60000"'),
    # A software device compiles each effect for seconds.
    (r"^(umbrage bench(?!.*--effect).*--device vulkan\S*)", r"\g<1> --effect sphere"),
    (r'""(scene:[^"]*)""', r'"\g<1>"'),
]

PLACEHOLDERS = [
    (r"scene:NAME", "scene:solids"), (r"--paper NAME", "--paper unsharp"), (r"#IFRAME#", "1"),
    (r"--quality NAME", "--quality draft"), (r"--look NAME", "--look lit"),
    (r"--effect NAME", "--effect sphere"), (r"(?<![$\w])BUNNY\b", "$BUNNY"),
    (r"\[?MODEL(\.\.\.)?\]?", "bunny.obj"), (r"IMAGE", "render.exr"), (r"-o FILE", "-o out.png"), (r"-o DIR", "-o out"),
    (r"\[?\bFILE\b\]?", "render.exr"), (r"WHAT \[NAME\]", "looks"), (r"\[?COMMAND\]?", "render"), (r"SHELL", "bash"),
]

def has_device(command, vulkan_devices):
    """Whether this machine has the Vulkan device and the instruction set that a command names."""
    device = re.search(r"--device vulkan:?(\d*)", command)
    isa = re.search(r"(?:UMBRAGE_ISA=|--isa )(\w+)", command)
    flag = {"avx512": "avx512f", "avx2": "avx2", "sse4": "sse4_2", "neon": "asimd"}.get(isa[1], "") if isa else ""
    has_isa = flag in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    return has_isa and (not device or int(device[1] or 0) < vulkan_devices)


# Commands that do not run everywhere, and what they need. An entry that matches no command is an error.
NEEDS = {
    r"-o \S+\.(mp4|webm|gif)\b": ("ffmpeg", lambda command, vulkan: shutil.which("ffmpeg")),
    r"--device vulkan|UMBRAGE_ISA=|--isa ": ("this device or instruction set", has_device),
}

# Commands whose exit code 1 is no failure here, and why.
MAY_DIFFER = {
    r"^umbrage figures": "the numbers of figures hold at their full size, at which the tests Figures.* check them",
    r"^umbrage tune .*--time ": "whether a setting is fast enough depends on the machine",
}

# Words in running text that name a command, or an option of it that takes no value, and are no complete command.
COMMANDS = "render|shade|view|thumbnails|compare|tune|figures|bench|info|list|help"
MENTION = re.compile(rf"^umbrage( ({COMMANDS}))?( --(?!help|version)[\w-]+)?$")
DRAWS = re.compile(r"^(\w+=\S+ )*umbrage (?!shade|view|thumbnails|compare|tune|figures|bench|info|list|help|completion|manual|-)")


MAKES_FILES = r"(cat >|python3 - (> \S+ )?<<|awk |cp /)"


def commands_of(text):
    """Returns (line, command, whether it is in running text) of each command of a page. Code blocks that make input files
    by other programs count as one command."""
    found = []
    start = r"(?:\w+=\S+ )*(?:time |/usr/bin/time -v )?umbrage "
    fenced, lines = False, text.split("\n")
    prose = []
    for number, line in enumerate(lines, 1):
        is_fence = re.match(r" *(```|~~~)", line)
        fenced = fenced != bool(is_fence)
        if is_fence and fenced and re.match(MAKES_FILES, "\n".join(lines[number:number + 1])):
            block = re.split(r"\n(?:```|~~~|umbrage )", "\n".join(lines[number:]))[0]
            found.append((number + 1, block, False))
        in_code = fenced or line.startswith("    ")
        prose.append("" if in_code or is_fence else line)
        if in_code and re.match(r"\s*" + start, line):
            words, next_line = line.strip(), number
            while words.endswith("\\") and next_line < len(lines):
                words = words[:-1].rstrip() + " " + lines[next_line].strip()
                next_line += 1
            found.append((number, re.split(r"\s+#|\s{2,}", words)[0], False))
    prose = "\n".join(prose)
    for match in re.finditer(r"(?<!`)`(?!`)([^`]+)`", prose):
        command = " ".join(match[1].replace("\\|", "|").split())
        if re.match(start, command) and "..." not in command and not MENTION.match(command):
            found.append((prose.count("\n", 0, match.start()) + 1, command, True))
    return sorted(found)


def runnable(command, in_text):
    """A command with small pictures, and with values for placeholders."""
    if re.match(MAKES_FILES, command):
        return command
    command = re.sub(r"^((?:\w+=\S+ )*)(?:time |/usr/bin/time -v )", r"\1", command)
    command = re.sub(r"\| man -l -$", "| cat", re.sub(r"\| source$", "| cat", command))
    for pattern, value in PLACEHOLDERS + CAPS:
        command = re.sub(pattern, value, command)
    if in_text and DRAWS.match(command) and not re.search(r" (-o|--output|--help)\b", command):
        command += " -o out.png"  # tables of measurements leave it out
    return command


def key_of(page, command):
    """Commands of one key run once. Commands that draw run once per page: others may use their output."""
    if not re.search(r"umbrage (figures|bench|compare|tune|list)\b", command):
        return page, command
    return re.sub(r"^(umbrage figures).*?( --paper (?!unsharp)\w+)?( --runs 1)?$", r"\1\2", re.sub(r" -o \S+", "", command))


def outputs(command):
    """Patterns of the files of which at least one must exist afterwards, for each output that a command names."""
    if re.match(MAKES_FILES, command):
        return []
    words = shlex.split(command.split(" | ")[0])
    named = [words[i + 1] for i, word in enumerate(words[:-1]) if word in ("-o", "--output", "--svg", "--contact-sheet", ">")]
    model = next((pathlib.PurePath(word).stem for word in words[1:] if "." in word), "")
    named = [name.replace("{stem}", model) for name in named]
    return [[re.sub(r"%0?\d*d|#+", "*", name), re.sub(r"(\.\w+)$", r"_*\1", name)] for name in named if name != "-"]


class Page:
    def __init__(self, name, program, made, vulkan):
        self.name, self.program, self.made, self.vulkan = name, program, made, vulkan
        self.failures, self.skipped, self.matched, self.ran = [], [], set(), 0

    def run(self, folder, done):
        text = (ROOT / self.name).read_text(encoding="utf-8")
        inputs.copy_inputs(text, self.made, folder)
        (folder / "docs/images").mkdir(parents=True)
        for line, written, in_text in commands_of(text):
            command = runnable(written, in_text)
            key = key_of(self.name, command)
            if key in done:
                continue
            done.add(key)
            lacking = [what for pattern, (what, has) in NEEDS.items()
                       if self.matches(pattern, command) and not has(command, self.vulkan)]
            if lacking:
                self.skipped.append(f"{self.name}:{line}: needs {lacking[0]}: {written}")
                continue
            problem = self.try_view(command, folder) if command.startswith("umbrage view") else self.try_command(command, folder)
            self.ran += 1
            if problem:
                self.failures.append(f"{self.name}:{line}: {written}\n  as {command}\n  {problem}")

    def matches(self, pattern, command):
        if not re.search(pattern, command):
            return False
        self.matched.add(pattern)
        return True

    def try_command(self, command, folder):
        expected = outputs(command)
        for pattern in (pattern for patterns in expected for pattern in patterns):
            for path in folder.glob(pattern):
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        try:
            done = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=folder, env=environment(self.program, self.made),
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return f"took more than {TIMEOUT_S} s"
        may_differ = [pattern for pattern in MAY_DIFFER if self.matches(pattern, command)]
        if done.returncode and not (may_differ and done.returncode == 1):
            return f"exit code {done.returncode}: {done.stderr.strip()[-800:]}"
        for patterns in expected:
            if not any(path.is_file() or any(path.iterdir()) for pattern in patterns for path in folder.glob(pattern)):
                return f"wrote no file {patterns[0]}"
        return None

    def try_view(self, command, folder):
        """Starts the viewer, loads its page, and ends it by Ctrl-C."""
        log = folder / "view.log"
        with log.open("w") as output, subprocess.Popen(
                shlex.split(command) + ["--no-open"], cwd=folder, env=environment(self.program, self.made),
                stdin=subprocess.DEVNULL, stdout=output, stderr=output) as viewer:
            stop = time.monotonic() + TIMEOUT_S
            address = None
            while not address and viewer.poll() is None and time.monotonic() < stop:
                time.sleep(0.05)
                address = re.search(r"http://\S+/", log.read_text(encoding="utf-8"))
            status = urllib.request.urlopen(address[0], timeout=TIMEOUT_S).status if address else None
            viewer.send_signal(signal.SIGINT)
            try:
                code = viewer.wait(TIMEOUT_S)
            except subprocess.TimeoutExpired:
                viewer.kill()
                return "did not end by Ctrl-C"
        if status == 200 and code == 0:
            return None
        return f"status {status} of its page, exit code {code}: {log.read_text(encoding='utf-8')[-800:]}"


def environment(program, made):
    kept = {key: value for key, value in os.environ.items() if not key.startswith("UMBRAGE_")}
    return {**kept, "PATH": f"{made / 'bin'}:{os.environ['PATH']}", "XDG_CONFIG_HOME": str(made / "config"),
            "BUNNY": str(made / "bunny.obj"), "UMBRAGE_DEVICE": "cpu", "UMBRAGE_NUM_THREADS": "1"}


def main():
    program = os.path.abspath(sys.argv[1])
    names = sys.argv[2:]
    every = not names
    if every:
        listed = subprocess.run(["git", "ls-files", "-z", "--", *(f":(glob){page}" for page in PAGES)], cwd=ROOT, check=True,
                                capture_output=True, text=True).stdout.split("\0")
        names = [name for name in listed if name and (ROOT / name).exists()]
    with tempfile.TemporaryDirectory(prefix="umbrage-commands.") as name:
        made = pathlib.Path(name)
        (made / "config/umbrage").mkdir(parents=True)
        (made / "config/umbrage/config").write_text(CONFIG, encoding="utf-8")
        (made / "bin").mkdir()
        (made / "bin/umbrage").symlink_to(program)
        env = environment(program, made)
        inputs.make_inputs(program, made, env)
        devices = subprocess.run([program, "list", "devices"], check=True, capture_output=True, text=True, env=env).stdout
        pages = [Page(page, program, made, devices.count("vulkan:")) for page in names]
        pages.sort(key=lambda page: -len(commands_of((ROOT / page.name).read_text(encoding="utf-8"))))
        done = set()

        def run(page):
            with tempfile.TemporaryDirectory(dir=made) as folder:
                page.run(pathlib.Path(folder), done)

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            list(pool.map(run, pages))
    failures = [failure for page in pages for failure in page.failures]
    matched = set().union(*(page.matched for page in pages))
    if every:
        failures += [f"no command matches the entry '{pattern}'" for pattern in [*NEEDS, *MAY_DIFFER] if pattern not in matched]
    print("\n".join(line for page in pages for line in page.skipped))
    number = sum(page.ran for page in pages)
    print(f"{number} commands of {len(pages)} pages ran, {len(failures)} failed")
    if every and number < len(pages):
        failures.append("fewer commands than pages: are they still found?")
    if failures:
        sys.exit("\n\n".join(failures))


if __name__ == "__main__":
    main()
