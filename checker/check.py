#!/usr/bin/env python3
"""Checks proof logs of `grouser optimize --certify`: check.py [--problem PROBLEM.toml] LOG.jsonl ...

A log holds one proof, which replay.py replays, or the proofs of a front, one after the other. Of a front also how its proofs
are joined is replayed. A log holds the text of its problem with its hash; with --problem it must be that of the file. Exit codes: 0 the logs prove what they claim, 1 one does not, 2 one cannot be read.
"""

import json
import sys

from replay import INF, Refused, check, check_point, check_text, need, operands, read_problem

FRONT = ("grouser-front", 1)


def numbered(known, head):
    """The rows of a proof by what they compute, numbered alike in all proofs of a front."""
    ids = []
    for name, *given in head["ops"]:
        if name in ("const", "var"):
            own = given
        else:
            own = [ids[a] for a in operands([name, *given])] + (given[1:] if name == "powi" else [])
        ids.append(known.setdefault((name, *own), len(known)))
    return sorted((kind, ids[node]) for kind, node, _ in head["rows"])


def finite(levels):
    """Levels of a log, where one without a bound is null."""
    return tuple(-INF if level is None else level for level in levels)


def moved(corner, objective, level):
    """A corner with another level of one objective."""
    return (corner[0], level) if objective else (level, corner[1])


class Base:
    """The proof of the least value of one objective alone, which begins a front."""

    def __init__(self, objective, limits, problem, lower):
        self.objective, self.limits, self.problem, self.lower = objective, limits, problem, lower


def check_front(lines):
    """Replays how the proofs of a front are joined; returns what they prove.

    Every feasible point lies above a corner in both objectives. A corner is cut where one objective is `at`: points beyond lie
    above the corner moved there, the others above the least value of the other objective, which a proof follows for.
    """
    known, bases, corners, end = {}, [], [], {}
    for entry in map(json.loads, lines):
        if "front" in entry:
            end = entry
            break
        k, at, head = entry["least"], entry["at"], json.loads(next(lines))
        status, lower, *_ = check(lines, head)
        lower = INF if status == "infeasible" else finite([lower])[0]
        rows, problem = numbered(known, head), read_problem(head)
        objective = [row for row in rows if row[0] == "objective"]
        limits = [row for row in rows if row[0] != "objective"]
        if at is None:
            alike = all(base.limits == limits and base.problem[0] == problem[0] for base in bases)
            need(k == len(bases) and alike, "the first proofs do not belong together")
            bases.append(Base(objective, limits, problem, lower))
            is_infeasible = any(base.lower == INF for base in bases)
            corners = [] if is_infeasible else [tuple(base.lower for base in bases)]
            continue
        need(len(bases) == 2, "a cut comes before the proofs of both objectives")
        own, other = bases[k], bases[1 - k]
        # the other objective is at most `at`: f <= 0 where that is 0, else f - at <= 0
        level = known.get(("const", at))
        cut = [("at_most", known.get(("sub", f, level), -1) if at else f) for _, f in other.objective]
        need(objective == own.objective and problem[0] == own.problem[0], "a cut is about another problem")
        need(limits == sorted(cut + own.limits), "a cut has other limits")
        corner = finite(entry["corner"])
        need(corner in corners, "there is no such corner")
        corners = [c for c in corners if c != corner] + [moved(corner, 1 - k, at)]
        if lower < INF:
            corners.append(moved(corner, k, max(corner[k], lower)))
    check_end(bases, corners, end)
    return f"{end['front']}: {len(end['corners'])} corners, {len(end['points'])} points, off by at most {end['tolerance']}"


def check_end(bases, corners, end):
    """The corners and points that are claimed are those that the cuts leave."""
    claimed, tolerance = [finite(corner) for corner in end["corners"]], end["tolerance"]
    for corner in corners:
        covered = any(c[0] <= corner[0] and c[1] <= corner[1] for c in claimed)
        need(covered, "what lies above a corner is not covered")
    # a front that ended before both proofs has no corner, one that is infeasible needs none
    is_begun = len(bases) == 2 or any(base.lower == INF for base in bases)
    need(end["front"] != "infeasible" or is_begun and not corners, "that there are no feasible points is not proved")
    need(end["front"] != "proved" or corners, "a front without corners is no front")
    for x, levels in end["points"]:
        for base, level in zip(bases, levels, strict=True):
            check_point(*base.problem, {**end, "x": x, "upper": level})
    if end["front"] != "proved" and None in tolerance:
        return

    def is_near(corner, levels):
        pairs = zip(levels, corner, tolerance)
        return all(level <= low + most + 1e-12 * (1 + abs(level)) for level, low, most in pairs)

    for corner in claimed:
        is_closed = any(is_near(corner, levels) for _, levels in end["points"])
        need(is_closed, "a corner leaves more open than the tolerance")


def verdict(path, source=None):
    """The exit code of one log, and a line about it. The text of its problem must be `source`, where that is given."""
    try:
        with open(path, encoding="utf-8") as log:
            head = json.loads(next(log))
            problem = check_text(head)
            need(source in (None, problem["text"]), "the log is about another problem")
            name = f", problem {problem['sha256'][:16]}" if problem["sha256"] else ""
            if (head["format"], head["version"]) == FRONT:
                return 0, f"accepted: {check_front(log)}{name}"
            status, lower, upper, leaves = check(log, head)
            return 0, f"accepted: {status}: lower {lower}, upper {upper}, {leaves} leaves{name}"
    except Refused as reason:
        return 1, f"refused: {reason}"
    except (OSError, ArithmeticError, ValueError, KeyError, TypeError, IndexError, AttributeError, StopIteration) as reason:
        return 2, f"refused: not a proof log: {type(reason).__name__}: {reason}"


if __name__ == "__main__":
    arguments, source = sys.argv[1:], None
    if arguments[:1] == ["--problem"] and len(arguments) > 1:
        with open(arguments[1], encoding="utf-8", newline="") as file:
            source, arguments = file.read(), arguments[2:]
    verdicts = [verdict(path, source) for path in arguments] or [(2, __doc__)]
    print("\n".join(line for _, line in verdicts))
    sys.exit(max(verdicts)[0])
