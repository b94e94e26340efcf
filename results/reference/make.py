#!/usr/bin/env python3
"""Makes the reference results anew, and checks what is committed.

    results/reference/make.py [--evbench PROGRAM] [NAME...]   runs the experiments (results/reference/experiments.json)
                                                              and writes their tables, CSV and manifests; what is
                                                              complete below results/ is not run again, so that an
                                                              interrupted call can be continued; -j N: runs at a time;
                                                              --run: leaves the pages as they are
    results/reference/make.py --list                          the experiments, with the processor time that each took
    results/reference/make.py --check [--evbench PROGRAM]     fails where a committed table was changed by hand, or was
                                                              made with other versions of plugins than the program has

An experiment is a name, the commands that run it into results/NAME, and the pages with its tables. A page has a table
between <!-- made by: evbench table ... --> (or compare, eval-tracks) and <!-- end -->, without its notes where the command
ends with "; without notes". <!-- made by: evbench figure ... --> makes a picture. A page may have tables of several
experiments: a table belongs to those whose results/NAME is in its command. Between <!-- made with --> and <!-- end -->
is what its experiments were run with, from their manifests.

evbench reproduce --reference runs the experiments. EVBENCH_EVENTS is the folder of simulated events that several of them
share; by default results/events.
"""

import argparse
import csv
import hashlib
import json
import os
import pathlib
import re
import resource
import shlex
import subprocess
import sys

REFERENCE = pathlib.Path(__file__).resolve().parent
ROOT = REFERENCE.parent.parent
BLOCK = re.compile(r"(<!-- made by: (evbench (?:table|compare|eval-tracks) [^\n]*?)(; without notes)? -->\n)(.*?)(<!-- end -->)", re.DOTALL)
PROVENANCE = re.compile(r"(<!-- made with -->\n)(.*?)(<!-- end -->)", re.DOTALL)
FIGURE = re.compile(r"<!-- made by: (evbench figure .*?) -->")


def experiments():
    return json.loads((REFERENCE / "experiments.json").read_text())["experiments"]


def run(program, command, **more):
    """Runs `evbench ...` in the root of the repository."""
    return subprocess.run([program, *shlex.split(command)[1:]], cwd=ROOT, check=True, **more)


def output(program, command):
    return run(program, command, stdout=subprocess.PIPE, text=True).stdout


def runs_of(folder):
    """job.json and manifest.json of each run of an experiment."""
    for path in sorted(folder.glob("**/manifest.json")):
        yield json.loads((path.parent / "job.json").read_text()), json.loads(path.read_text())


def versions_of(job):
    for part in ("source", "frontend", "backend"):
        yield f'{part} {job[part]["type"]}', job[part]["version"]


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_experiment(program, experiment, folder, jobs):
    """Runs what is not complete, and returns the processor time of all calls."""
    record = folder / "processor_s.txt"
    before = float(record.read_text()) if record.exists() else 0
    begin = processor_time()
    words = [program, "reproduce", "--reference", experiment["name"], *(["-j", str(jobs)] if jobs else [])]
    try:
        result = subprocess.run(words, cwd=ROOT)
        if result.returncode not in (0, 3):  # 3: runs failed, which the tables show
            raise SystemExit(f"{experiment['name']}: ended with {result.returncode}")
    finally:
        spent = before + processor_time() - begin
        if folder.exists():
            record.write_text(f"{spent:.1f}\n")
    return spent


def manifest(name, folder, seconds):
    plugins, commits, hosts, seeds, versions, days = {}, set(), set(), set(), set(), set()
    count = 0
    for job, made in runs_of(folder):
        count += 1
        for plugin, version in versions_of(job):
            plugins.setdefault(plugin, set()).add(version)
        commits.add(made["program"]["commit"])
        versions.add(made["program"]["version"])
        hosts.add(f'{made["host"]["processor"]}, {made["host"]["cores"]} cores')
        seeds.add(job["seed"])
        days.add(made["finished"][:10])
    mixed = {plugin: sorted(known) for plugin, known in plugins.items() if len(known) > 1}
    if mixed:
        raise SystemExit(f"{name}: runs of several versions are in {folder}: {mixed}; expected one of each: remove the older")
    return {"experiment": name, "runs": count, "program": sorted(versions), "commits": sorted(commits),
            "plugins": {plugin: known.pop() for plugin, known in sorted(plugins.items())}, "seeds": sorted(seeds),
            "hosts": sorted(hosts), "days": sorted(days), "processor_s": round(seconds)}


def write_csv(program, folder, path):
    """A row per run, without columns that name folders or times of this machine."""
    table = output(program, f"evbench table {folder} --format csv --all")
    rows = [row for row in csv.DictReader(table.splitlines()) if row["status"] != "not run"]
    left_out = {"folder", "reason", "protocol"} | {key for key in rows[0] if key.startswith("times.")}
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, [key for key in rows[0] if key not in left_out], extrasaction="ignore",
                                lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def belongs_to(name, command):
    return any(word == f"results/{name}" or word.startswith(f"results/{name}/") for word in command.split())


def fill(program, page, name):
    """Writes the tables and pictures of an experiment in a page, and returns the digests of its tables."""
    text = page.read_text()
    for command in FIGURE.findall(text):
        if belongs_to(name, command):
            run(program, command)

    def made(block):
        if not belongs_to(name, block[2]):
            return block[0]
        table = output(program, block[2])
        return block[1] + "\n" + (table.split("\n\n")[0] if block[3] else table).rstrip() + "\n\n" + block[5]

    text = BLOCK.sub(made, text)
    page.write_text(text)
    return digests(text, name)


def digests(text, name):
    return [digest(block[3]) for block in BLOCK.findall(text) if belongs_to(name, block[1])]


def ranges(numbers):
    """1, 2, 3, 7 as "1 to 3, 7"."""
    parts = []
    for number in sorted(numbers):
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(a) if a == b else f"{a} to {b}" for a, b in parts)


def minutes(made):
    return f"{max(1, round(made['processor_s'] / 60))} min" if "processor_s" in made else ""


def provenance(page):
    """A table of what the experiments of a page were run with."""
    rows = ["| experiment | runs | seeds | evbench | plugins | processor | processor time | day |",
            "| --- | ---: | --- | --- | --- | --- | ---: | --- |"]
    for experiment in experiments():
        record = REFERENCE / f"{experiment['name']}.manifest.json"
        if page not in experiment["pages"] or not record.exists():
            continue
        made = json.loads(record.read_text())
        plugins = ", ".join(f"{plugin.split()[1]} {version}" for plugin, version in made["plugins"].items())
        rows.append(f"| `{made['experiment']}` | {made['runs']} | {ranges(made['seeds'])} | {', '.join(made['program'])} "
                    f"({', '.join(made['commits'])}) | {plugins} | {'; '.join(made['hosts'])} | "
                    f"{minutes(made)} | {', '.join(made['days'])} |")
    return "\n" + "\n".join(rows) + "\n\n"


def fill_provenance(page):
    text = (ROOT / page).read_text()
    (ROOT / page).write_text(PROVENANCE.sub(lambda block: block[1] + provenance(page) + block[3], text))


def make(program, names, jobs, only_run):
    for experiment in experiments():
        name = experiment["name"]
        if names and name not in names:
            continue
        missing = [variable for variable in experiment.get("needs", []) if not os.environ.get(variable)]
        if missing:
            print(f"{name}: left out: {', '.join(missing)} is not set")
            continue
        folder = ROOT / "results" / name
        spent = run_experiment(program, experiment, folder, jobs)
        if only_run:
            continue
        made = manifest(name, folder, spent)
        write_csv(program, folder.relative_to(ROOT), REFERENCE / f"{name}.csv")
        made["csv"] = digest((REFERENCE / f"{name}.csv").read_text())
        made["tables"] = {page: fill(program, ROOT / page, name) for page in experiment["pages"]}
        (REFERENCE / f"{name}.manifest.json").write_text(json.dumps(made, indent=1) + "\n")
        for page in experiment["pages"]:
            fill_provenance(page)


def present_versions(program):
    versions, part = {}, ""
    for line in output(program, "evbench list").splitlines():
        if found := re.match(r"(\w+):$", line):
            part = found[1]
        elif found := re.match(r"  (\S+) +(\d+) +\S", line):
            versions[f"{part} {found[1]}"] = int(found[2])
    return versions


def check(program):
    faults = []
    now = present_versions(program)
    pages = set()
    for experiment in experiments():
        record = REFERENCE / f"{experiment['name']}.manifest.json"
        if not record.exists():
            faults.append(f"{experiment['name']}: was never made; results/reference/make.py {experiment['name']}")
            continue
        made = json.loads(record.read_text())
        for page, known in made["tables"].items():
            pages.add(page)
            if digests((ROOT / page).read_text(), experiment["name"]) != known:
                faults.append(f"{page}: a table of {experiment['name']} is not as it was made")
        for plugin, version in made["plugins"].items():
            if now.get(plugin) != version:
                faults.append(f"{experiment['name']}: was made with {plugin} {version}, the program has "
                              f"{now.get(plugin, 'none')}; results/reference/make.py {experiment['name']}")
        if digest((REFERENCE / f"{experiment['name']}.csv").read_text()) != made["csv"]:
            faults.append(f"{experiment['name']}.csv is not as it was made")
    for page in sorted(pages):
        if any(block[2] != provenance(page) for block in PROVENANCE.finditer((ROOT / page).read_text())):
            faults.append(f"{page}: what it was made with is not as its manifests say")
    for fault in faults:
        print(fault)
    print(f"{len(pages)} pages of reference results, {len(faults)} faults")
    return 1 if faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--evbench", default=str(ROOT / "build/release/bin/evbench"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--run", action="store_true")
    parser.add_argument("-j", "--jobs", type=int)
    parser.add_argument("names", nargs="*")
    arguments = parser.parse_args()
    if arguments.list:
        for experiment in experiments():
            record = REFERENCE / f"{experiment['name']}.manifest.json"
            known = json.loads(record.read_text()).get("processor_s", "?") if record.exists() else None
            spent = f"{known} s" if known else "never made"
            print(f"{experiment['name']:<28} {spent:<12} {'; '.join(experiment['commands'])}")
        return 0
    program = str(pathlib.Path(arguments.evbench).resolve())
    if arguments.check:
        return check(program)
    unknown = set(arguments.names) - {experiment["name"] for experiment in experiments()}
    if unknown:
        parser.error(f"there is no experiment {', '.join(sorted(unknown))}; see --list")
    make(program, arguments.names, arguments.jobs, arguments.run)
    return 0


if __name__ == "__main__":
    sys.exit(main())
