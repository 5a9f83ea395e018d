#!/usr/bin/env python3
"""mutants/run.py CRATE [--share K/N] [--only REGEX] [--slow S] [--again FILE]: every mutant of a crate against its fast tests.

README.md has how. Prints each mutant that no test notices and that argued.tsv does not argue; fails if there is one.
"""

import argparse
import collections
import hashlib
import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
arguments = argparse.ArgumentParser()
arguments.add_argument("crate")
arguments.add_argument("--share", default="0/1", help="the mutants whose number leaves K when divided by N")
arguments.add_argument("--only", default="", help="those of files, as src/FILE:LINE:COLUMN, that match")
arguments.add_argument("--slow", type=float, default=1.0, help="tests that take longer alone are left out, s of processor time")
arguments.add_argument("--again", type=Path, help="those that the output of an earlier run lists")
arguments = arguments.parse_args()
SLOW_S = arguments.slow
# after so much processor time a mutant counts as not caught, s
BUDGET_S = 4.0 * SLOW_S
crate = arguments.crate
remainder, shares = (int(part, 0) for part in arguments.share.split("/"))

target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "mutants"
tree = target / crate / "tree"
list_file, excluded_file, seen_file = (target / crate / name for name in ("list", "excluded", "seen"))
tree.mkdir(parents=True, exist_ok=True)
environment = dict(
    os.environ,
    CARGO_TARGET_DIR=str(target / "build"),
    RUSTFLAGS="--cap-lints allow",
    # as the workspace builds them, 86 more of the estimators' tests take longer than a second
    CARGO_PROFILE_DEV_OPT_LEVEL="2",
    PROPTEST_RNG_SEED="2012",
    CARGO_MANIFEST_DIR=str(tree / "crates" / crate),
    GROUSER_DATA=os.environ.get("GROUSER_DATA", str(ROOT / "data")),
)


def cargo(*words):
    """The messages of a cargo command in the mutated tree, and whether it succeeded."""
    done = subprocess.run(["cargo", *words, "--message-format=json"], cwd=tree, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return messages, done.returncode == 0, done.stderr


def copy_tree():
    """The files of the repository, with new times only where they changed."""
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", "crates",
                            "examples", "docs", "checker", "Cargo.toml", "Cargo.lock", "clippy.toml", "README.md"],
                           cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    for name in names:
        source, copy = ROOT / name, tree / name
        if source.is_file() and (not copy.exists() or copy.read_bytes() != source.read_bytes()):
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(source.read_bytes())
    kept = {tree / name for name in names}
    for path in (tree / "crates").rglob("*"):
        if path.is_file() and path not in kept:
            path.unlink()


def excluded_by(error, mutants):
    """What the compiler does not take: the mutants in an error's place, or a function that must stay `const`."""
    for span in error["spans"]:
        path = tree / span["file_name"]
        if not span["is_primary"] or not path.exists():
            continue
        if (error.get("code") or {}).get("code") == "E0015":
            name = re.search(r"`(?:[^`]*::)?(\w+)(?:::<[^`]*>)?`", error["message"])
            if name:
                yield f"const {name[1]}"
                continue
        text = path.read_bytes()
        find = lambda part: re.findall(r"mutant::active\((\d+)u32\)", part.decode(errors="ignore"))
        for number in find(text[span["byte_start"]:span["byte_end"]]) or find(text[:span["byte_start"]])[-1:]:
            yield f"{mutants[number][1]} {mutants[number][3]}"


def write_mutants():
    """Writes the mutants that compile; gives them as (number, place, function, mutation)."""
    excluded = set(excluded_file.read_text().splitlines()) if excluded_file.exists() else set()
    sources = tree / "crates" / crate / "src"
    while True:
        copy_tree()
        excluded_file.write_text("\n".join(sorted(excluded)))
        subprocess.run(["cargo", "run", "--quiet", "--manifest-path", ROOT / "mutants" / "Cargo.toml", "--target-dir",
                        target / "tool", "--", sources, list_file, excluded_file], check=True)
        mutants = [line.split("\t") for line in list_file.read_text().splitlines()]
        messages, ok, said = cargo("check", "--package", f"grouser-{crate}", "--lib")
        if ok:
            return mutants, len(excluded)
        errors = [m["message"] for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"]
        by_number = {mutant[0]: mutant for mutant in mutants}
        more = {name for error in errors for name in excluded_by(error, by_number)} - excluded
        if not more:
            sys.exit(f"the mutated crate does not compile\n{said}")
        excluded |= more


def run(program, test, mutant, limit_s):
    """Whether a test passes beside a mutant, and its processor time, s. A mutant that hangs runs into the limit."""
    own = dict(environment, GROUSER_MUTANT=str(mutant), GROUSER_MUTANT_TRACE=str(seen_file))
    limits = lambda: (resource.setrlimit(resource.RLIMIT_CPU, (int(limit_s) + 1,) * 2),
                      resource.setrlimit(resource.RLIMIT_AS, (8 << 30,) * 2))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        code = subprocess.run([program, "--exact", test, "--test-threads=1"], cwd=environment["CARGO_MANIFEST_DIR"], env=own,
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              preexec_fn=limits, timeout=60 + 30 * limit_s).returncode
    except subprocess.TimeoutExpired:
        code = None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code == 0, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def names_of(program, *more):
    said = subprocess.run([program, "--list", "--format=terse", *more], env=environment, cwd=tree, capture_output=True, text=True)
    return [line.removesuffix(": test") for line in said.stdout.splitlines() if line.endswith(": test")]


def fast_tests():
    """The tests that pass within SLOW_S, with their time and the mutants that each reaches."""
    messages, ok, said = cargo("test", "--package", f"grouser-{crate}", "--lib", "--tests", "--no-run")
    if not ok:
        sys.exit(said)
    programs = [m["executable"] for m in messages if m.get("executable") and m["profile"]["test"]]
    key = hashlib.sha256(b"".join(Path(program).read_bytes() for program in programs)).hexdigest() + f" {SLOW_S}"
    cache = target / crate / "tests.json"
    if cache.exists() and (kept := json.loads(cache.read_text()))["key"] == key:
        return kept["tests"]
    tests = []
    for program in programs:
        for test in set(names_of(program)) - set(names_of(program, "--ignored")):
            passes, time_s = run(program, test, 0, 4 * SLOW_S)
            if not passes or time_s > SLOW_S:
                continue
            seen_file.unlink(missing_ok=True)
            run(program, test, "trace", 40 * SLOW_S)
            reached = sorted(map(int, seen_file.read_text().split())) if seen_file.exists() else []
            tests.append((program, test, time_s, reached))
    cache.write_text(json.dumps({"key": key, "tests": tests}))
    return tests


def line_of(mutant):
    """What the output has of a mutant that is not caught."""
    _, place, function, mutation = mutant
    return f"not caught: crates/{crate}/src/{place} {function}: {mutation}"


mutants, excluded = write_mutants()
tests = fast_tests()
print(f"{len(mutants)} mutants that compile, {excluded} that do not; {len(tests)} tests, {sum(t[2] for t in tests):.1f} s", flush=True)
reaching = collections.defaultdict(list)
for index, (_, _, _, reached) in enumerate(tests):
    for number in reached:
        reaching[number].append(index)
chosen = [m for m in mutants if int(m[0]) % shares == remainder % shares and re.search(arguments.only, "src/" + m[1])]
if arguments.again:
    listed = set(arguments.again.read_text().splitlines())
    chosen = [m for m in chosen if line_of(m) in listed]
# each line argues for so many mutants of a function: lines move, functions do not
argued = collections.Counter()
for line in (ROOT / "mutants" / "argued.tsv").read_text().splitlines()[1:]:
    of, file, function, mutation, count, _ = line.split("\t")
    if of == crate:
        argued[file, function, mutation] += int(count)
# tests that caught others of a function or file go first, then the shorter ones
caught_by = collections.defaultdict(collections.Counter)
missed, open_ones = 0, 0
for number, place, function, mutation in chosen:
    file = place.split(":")[0]
    worth = lambda index: (1 + 3 * caught_by[function][index] + caught_by[file][index]) / (0.01 + tests[index][2])
    caught, spent_s = False, 0.0
    for index in sorted(reaching[int(number)], key=worth, reverse=True):
        program, test, time_s, _ = tests[index]
        passes, used_s = run(program, test, number, 3.0 * time_s + 1.0)
        spent_s += used_s
        if not passes:
            caught = True
            caught_by[function][index] += 1
            caught_by[file][index] += 1
        if caught or spent_s > BUDGET_S:
            break
    if caught:
        continue
    missed += 1
    if argued[file, function, mutation] > 0:
        argued[file, function, mutation] -= 1
        continue
    open_ones += 1
    print(line_of((number, place, function, mutation)), flush=True)
print(f"{len(chosen)} mutants run, {missed} not caught, {missed - open_ones} of them argued")
sys.exit(bool(open_ones))
