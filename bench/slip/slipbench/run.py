"""Runs of worlds through entrants, and the figures of all."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import multiprocessing
import pathlib
import resource
import sys
import time
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from slipbench import score
from slipbench.entrants import ENTRANTS
from slipbench.log import Run
from slipbench.worlds import SIMULATED
from slipbench.worlds.measured import MEASURED, files


class Task(NamedTuple):
    """A run to make: of a simulated world by its seed, or of a file."""

    world: str
    seed: int
    path: Optional[pathlib.Path]


class Result(NamedTuple):
    """Outcomes of a run by entrant; `made_s` is the processor time of the world itself."""

    world: str
    seed: int
    fault: str
    made_s: float
    outcomes: Dict[str, score.Outcome]

    def to_json(self) -> str:
        outcomes = {name: dataclasses.asdict(outcome) for name, outcome in self.outcomes.items()}
        return json.dumps(self._asdict() | {"outcomes": outcomes})

    @staticmethod
    def from_json(text: str) -> Result:
        values = json.loads(text)
        for name, outcome in values["outcomes"].items():
            wheels = {wheel: score.WheelScore(**sums) for wheel, sums in outcome.pop("wheels").items()}
            values["outcomes"][name] = score.Outcome(wheels, **outcome)
        return Result(**values)


def tasks(worlds: Sequence[str], seeds: Sequence[int], data: Optional[pathlib.Path]) -> List[Task]:
    found = [Task(world, seed, None) for world in SIMULATED if world in worlds for seed in seeds]
    for world in MEASURED:
        if world in worlds and data is not None:
            found += [Task(world, k, path) for k, path in enumerate(files(data, world))]
    return found


def make(task: Task) -> Run:
    if task.path is None:
        return SIMULATED[task.world].make(task.world, task.seed)
    return MEASURED[task.world][1](task.world, task.seed, task.path)


def spent_s() -> float:
    """Processor time of this process and of its finished children."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def do(task: Task, entrants: Sequence[str]) -> Result:
    began = spent_s()
    run = make(task)
    made_s = spent_s() - began
    outcomes = {}
    for name in entrants:
        if name == "ratio" and run.log.reference.kind != "free-wheel":
            continue
        began, failure = spent_s(), None
        try:
            estimates = ENTRANTS[name].estimate(run.log)
        except Exception as error:  # an entrant that fails has no answers, and the others go on
            estimates, failure = {}, f"{type(error).__name__}: {error}"
        outcomes[name] = score.Outcome(score.of_run(run, estimates), spent_s() - began, len(run.log.time_s), failure)
    return Result(run.world, run.seed, run.fault, made_s, outcomes)


def results(todo: Sequence[Task], entrants: Sequence[str], jobs: int) -> Iterator[Result]:
    """In the order of the tasks, whatever the number of processes."""
    if jobs == 1:
        yield from (do(task, entrants) for task in todo)
        return
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(jobs, mp_context=context) as pool:
        yield from pool.map(do, todo, [entrants] * len(todo))


def all_of(todo: Sequence[Task], entrants: Sequence[str], jobs: int, store: pathlib.Path) -> List[Result]:
    """The results of all tasks. Each is appended to the store, and what the store holds already is not done again."""
    lines = store.read_text().splitlines() if store.exists() else []
    known = {(one.world, one.seed): one for one in map(Result.from_json, lines)}
    open_tasks = [task for task in todo if (task.world, task.seed) not in known]
    began = time.monotonic()
    with store.open("a") as out:
        for k, one in enumerate(results(open_tasks, entrants, jobs)):
            out.write(one.to_json() + "\n")
            out.flush()
            known[(one.world, one.seed)] = one
            if sys.stderr.isatty() or k % 20 == 19:
                print(f"{k + 1} of {len(open_tasks)} runs, {time.monotonic() - began:.0f} s", file=sys.stderr)
    return [known[(task.world, task.seed)] for task in todo]


def grouped(found: Sequence[Result], key: Callable[[Result], str]) -> Dict[Tuple[str, str], score.Score]:
    """Scores by group and entrant, in the order of the results."""
    groups: Dict[Tuple[str, str], List[score.Outcome]] = {}
    for result in found:
        for name, outcome in result.outcomes.items():
            groups.setdefault((key(result), name), []).append(outcome)
    return {names: score.of_world(outcomes) for names, outcomes in groups.items()}
