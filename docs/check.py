#!/usr/bin/env python3
"""Checks the repository's Markdown pages: what they link to, how long they are, and the commands that they show.

    docs/check.py --links                              links, anchors, lengths, marks of blocks
    docs/check.py --commands --evbench PATH [PAGE...]  runs the console blocks of all pages, or of these

A ```console block holds commands, lines that begin with "$ ", and what each prints, both streams together. A command
continues in the next line where its line ends with a backslash, and in lines that begin with "> ". In the output "..."
alone on a line stands for any lines, within a line for any text. A command must end with exit code 0, unless the last
line of its output is "[exit N]". The blocks of a page run one after the other in one temporary folder, in which
`configs` is the repository's. The working directory and exported variables stay from one command to the next.

A comment <!-- not run: REASON --> before a block of console, sh or bash says why it is not run; sh and bash never are.
"""

import argparse
import concurrent.futures
import functools
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
LONGEST_PAGE, LONGEST_README = 300, 120  # lines
GENERATED = ("docs/reference/command_line.md", "docs/reference/configuration.md")
FOLDERS = "core|eval|frontends|backends|bench|configs|cmake|examples|docs"
# What the program prints of work that takes long, as it does on a slow machine: "TITLE  3 of 9 done", "TITLE  2 million".
PROGRESS = re.compile(r"\S.*  [\d.]+ (of|million|thousand) [\d.]*.*")
NOT_RUN = re.compile(r"<!--\s*not run:\s*\S.*-->")


class Block:
    """A fenced block of a page: its language, the number of its first line, its lines, and why it is not run."""

    def __init__(self, language, number, lines, not_run):
        self.language, self.number, self.lines, self.not_run = language, number, lines, not_run


class Command:
    """A command of a console block, and what it is expected to print."""

    def __init__(self, number, text):
        self.number, self.text, self.expected = number, text, []


# Pages.


def parse(text):
    """The blocks of a page, and its lines, those of blocks emptied."""
    blocks, prose, before = [], [], ""
    fence = None
    for number, line in enumerate(text.splitlines(), 1):
        if fence is None:
            opening = re.match(r"\s*(`{3,}|~{3,})\s*([\w+-]*)", line)
            if opening:
                fence = opening[1]
                blocks.append(Block(opening[2], number + 1, [], bool(NOT_RUN.search(before))))
                prose.append("")
            else:
                prose.append(line)
            before = line if line.strip() else before
        else:
            prose.append("")
            if line.strip().startswith(fence) and not line.strip().strip(fence[0]):
                fence, before = None, ""
            else:
                blocks[-1].lines.append(line)
    return blocks, prose


def without_code(line):
    return re.sub(r"(`+)(.+?)\1", "", line)


def slug(heading):
    """The anchor that GitHub gives to a heading."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    text = re.sub(r"[^\w\- ]", "", text.strip().lower())
    return text.replace(" ", "-")


def anchors(text):
    found, counts = set(), {}
    for line in parse(text)[1]:
        found.update(re.findall(r"<a\s+(?:id|name)=\"([^\"]+)\"", line))
        heading = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if heading:
            name = slug(heading[1])
            count = counts.get(name, 0)
            counts[name] = count + 1
            found.add(f"{name}-{count}" if count else name)
    return found


def links(text):
    """Number of the line and target of each link and picture."""
    patterns = (r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", r"^\s*\[[^\]^]+\]:\s+<?(\S+?)>?(?:\s|$)",
                r"<(?:a|img)\s[^>]*(?:href|src)=\"([^\"]+)\"")
    for number, line in enumerate(parse(text)[1], 1):
        for pattern in patterns:
            for target in re.findall(pattern, without_code(line)):
                yield number, target


def pages_of(root):
    """The Markdown pages of a repository, relative to it: what git knows or would add."""
    git = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard", "*.md"],
                         capture_output=True, text=True)
    if git.returncode == 0:
        names = set(git.stdout.splitlines())
    else:
        names = {str(path.relative_to(root)) for path in root.rglob("*.md")}
        names = {name for name in names if not name.startswith("build")}
    return sorted(name for name in names if (root / name).is_file())


@functools.lru_cache(maxsize=None)
def anchors_of(path):
    return anchors(path.read_text(encoding="utf-8"))


@functools.lru_cache(maxsize=None)
def site_pages(root):
    """The pages that mkdocs.yml names."""
    site = root / "mkdocs.yml"
    return set(re.findall(r"\S+\.md", site.read_text(encoding="utf-8"))) if site.exists() else set()


def link_fault(root, page, target):
    """What is wrong with a link of a page; empty: nothing."""
    if re.match(r"[a-z][a-z0-9+.-]*:", target) or target.startswith("//"):
        return ""
    name, _, anchor = target.partition("#")
    name = urllib.parse.unquote(name)
    if name.startswith("/"):
        return f"{target}: expected a relative link"
    path = (root / page).parent / name if name else root / page
    if not path.exists():
        return f"{target}: there is no {os.path.relpath(path, root)}"
    if root not in (path.resolve(), *path.resolve().parents):
        return f"{target}: is outside the repository"
    if anchor and path.suffix == ".md" and anchor not in anchors_of(path.resolve()):
        return f"{target}: {os.path.relpath(path, root)} has no heading #{anchor}"
    return ""


def layout_faults(prose):
    """Lists and tables that a renderer other than GitHub's would take for text, as no blank line is before them."""
    kinds = (r"\s*(?:[-*+]|\d+\.)\s+\S", r"\s*\|")
    for number, (before, line) in enumerate(zip(prose, prose[1:]), 2):
        for kind in kinds:
            if re.match(kind, line) and before.strip() and not re.match(kind, before) and not before.startswith(" "):
                yield number, "a list or table needs a blank line before it"


def path_faults(root, prose):
    """Paths of the repository's files in backticks that do not exist; "*" stands for anything."""
    for number, line in enumerate(prose, 1):
        for path in re.findall(r"`((?:%s)/[\w./*-]+\.[a-z]+\*?|(?:%s)/[\w./-]+\.\*)`" % (FOLDERS, FOLDERS), line):
            if "..." not in path and "NAME" not in path and next(root.glob(path), None) is None:
                yield number, f"{path}: there is no such file"


def page_faults(root, page):
    """Faults of a page: number of the line, sentence."""
    text = (root / page).read_text(encoding="utf-8")
    blocks, prose = parse(text)
    for number, target in links(text):
        fault = link_fault(root, page, target)
        if fault:
            yield number, fault
    length = len(text.splitlines())
    longest = LONGEST_README if page == "README.md" else LONGEST_PAGE if page.startswith("docs/") else None
    if longest is not None and length > longest and page not in GENERATED:
        yield length, f"has {length} lines; expected at most {longest}"
    for block in blocks:
        if block.language in ("sh", "bash") and not block.not_run:
            yield (block.number - 1,
                   f"```{block.language}: is never run; expected ```console, or <!-- not run: REASON -->")
        if block.language == "console" and not block.not_run and not commands(block):
            yield block.number - 1, "```console: has no line that begins with \"$ \""
    if page.startswith("docs/"):
        yield from layout_faults(prose)
        yield from path_faults(root, prose)
        if page[len("docs/"):] not in site_pages(root):
            yield 1, "is not in the nav of mkdocs.yml"


def check_links(root, pages):
    count = 0
    for page in pages:
        for number, fault in sorted(page_faults(root, page)):
            print(f"{page}:{number}: {fault}")
            count += 1
    print(f"{len(pages)} pages, {count} faults")
    return count == 0


# Commands.


def commands(block):
    """The commands of a console block."""
    result, continued = [], False
    for number, line in enumerate(block.lines, block.number):
        if line.startswith("$ "):
            result.append(Command(number, line[2:]))
        elif result and (continued or (line.startswith("> ") or line == ">") and not result[-1].expected):
            result[-1].text += "\n" + (line[2:] if line.startswith(">") else line)
        elif result:
            result[-1].expected.append(line)
        continued = bool(result) and not result[-1].expected and line.endswith("\\")
    return result


def line_matches(expected, actual):
    pattern = ".*".join(re.escape(part) for part in expected.rstrip().split("..."))
    return re.fullmatch(pattern, actual.rstrip()) is not None


def compare(expected, actual):
    """The lines as a diff ("- " expected, "+ " actual, "~ " what "..." stands for), and whether they match."""
    n, m = len(expected), len(actual)
    any_lines = [line.strip() == "..." for line in expected]
    cost = [[0] * (m + 1) for _ in range(n + 1)]
    for i in range(n, -1, -1):
        for j in range(m, -1, -1):
            if i == n and j == m:
                continue
            choices = []
            if i < n:
                choices.append(cost[i + 1][j] + (0 if any_lines[i] else 1))
            if j < m:
                choices.append(cost[i][j + 1] + (0 if i < n and any_lines[i] else 1))
            if i < n and j < m and line_matches(expected[i], actual[j]):
                choices.append(cost[i + 1][j + 1])
            cost[i][j] = min(choices)
    diff, i, j = [], 0, 0
    while i < n or j < m:
        if i < n and any_lines[i] and j < m and cost[i][j] == cost[i][j + 1]:
            diff.append("~ " + actual[j])
            j += 1
        elif i < n and any_lines[i] and cost[i][j] == cost[i + 1][j]:
            diff.append("  ...")
            i += 1
        elif i < n and j < m and line_matches(expected[i], actual[j]) and cost[i][j] == cost[i + 1][j + 1]:
            diff.append("  " + actual[j])
            i, j = i + 1, j + 1
        elif i < n and cost[i][j] == cost[i + 1][j] + 1:
            diff.append("- " + expected[i])
            i += 1
        else:
            diff.append("+ " + actual[j])
            j += 1
    return diff, cost[0][0] == 0


def shortened(diff, most=6):
    """Without the middle of long runs of what "..." stands for."""
    result = []
    for i, line in enumerate(diff):
        of_dots = all(other.startswith("~ ") for other in diff[max(0, i - most):i + most + 1])
        if not of_dots:
            result.append(line)
        elif not result or result[-1] != "~ ...":
            result.append("~ ...")
    return result


def without_blank_ends(lines):
    while lines and not lines[-1].strip():
        lines = lines[:-1]
    return lines


# Runs a command ($2) after what the one before has left ($1), and leaves its folder and its variables.
SHELL = """[ -f "$1" ] && . "$1"
eval "$2"
code=$?
{ printf 'cd %q\\n' "$PWD"; export -p; } > "$1"
exit $code"""


def run(command, folder, state, environment, timeout):
    """The lines that a command prints, with its exit code where that is not 0."""
    process = subprocess.Popen(["bash", "--noprofile", "--norc", "-c", SHELL, "bash", state, command], cwd=folder,
                               env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, start_new_session=True)
    late = ""
    try:
        output, _ = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        late = f"[not done within {timeout:g} s]"
    lines = without_blank_ends(output.decode("utf-8", "replace").splitlines())
    if late:
        return lines + [late]
    return lines + ([f"[exit {process.returncode}]"] if process.returncode else [])


def environment_for(program):
    kept = {name: value for name, value in os.environ.items() if not name.startswith("EVBENCH_")}
    return {**kept, "PATH": f"{program.parent}:{kept.get('PATH', '')}", "COLUMNS": "120", "LC_ALL": "C.UTF-8"}


def run_page(root, page, program, timeout):
    """Number of commands of a page, and a text for each that fails."""
    blocks, _ = parse((root / page).read_text(encoding="utf-8"))
    count, failures = 0, []
    with tempfile.TemporaryDirectory(prefix="evbench-docs-") as folder:
        work = pathlib.Path(folder) / "work"
        work.mkdir()
        if (root / "configs").exists():
            (work / "configs").symlink_to(root / "configs")
        state = str(pathlib.Path(folder) / "state")
        for block in blocks:
            if block.language != "console" or block.not_run:
                continue
            for command in commands(block):
                count += 1
                actual = run(command.text, work, state, environment_for(program), timeout)
                if not any(PROGRESS.fullmatch(line) for line in command.expected):
                    actual = [line for line in actual if not PROGRESS.fullmatch(line)]
                diff, matches = compare(without_blank_ends(command.expected), actual)
                if not matches:
                    lines = [f"{page}:{command.number}: $ {command.text}"] + ["    " + line for line in shortened(diff)]
                    failures.append("\n".join(lines))
    return count, failures


def check_commands(root, pages, program, jobs, timeout):
    total, failed = 0, 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = pool.map(lambda page: run_page(root, page, program, timeout), pages)
        for page, (count, failures) in zip(pages, results):
            total, failed = total + count, failed + len(failures)
            for failure in failures:
                print(failure)
            if count:
                print(f"{page}: {count - len(failures)} of {count} commands do what the page says", flush=True)
    print(f"{total} commands, {failed} failures")
    return failed == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--links", action="store_true", help="links, anchors, lengths, marks of blocks")
    parser.add_argument("--commands", action="store_true", help="run console blocks")
    parser.add_argument("--evbench", type=pathlib.Path, help="path of the program, for --commands")
    parser.add_argument("--limit", type=float, default=180.0, metavar="SECONDS",
                        help="how long a command may take: one that takes longer hangs (default: 180)")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="pages whose commands run at a time")
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="only these pages")
    arguments = parser.parse_args()
    if not arguments.links and not arguments.commands:
        parser.error("expected --links or --commands")
    if arguments.commands and not (arguments.evbench and arguments.evbench.is_file()):
        parser.error("--commands needs --evbench, the path of the program")
    pages = [os.path.relpath(page, ROOT) for page in map(os.path.abspath, arguments.pages)] or pages_of(ROOT)
    good = True
    if arguments.links:
        good = check_links(ROOT, pages)
    if arguments.commands:
        good = check_commands(ROOT, pages, arguments.evbench.resolve(), arguments.jobs, arguments.limit) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
