"""The entrants: each a function from a log to slips with 90 % intervals."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import Callable, Dict

from slipbench.entrants import grouser
from slipbench.entrants.ekf import robot_localization
from slipbench.entrants.means import ratio_of_counts, window_mean
from slipbench.log import Estimates, Log


@dataclasses.dataclass(frozen=True)
class Entrant:
    """`is_causal`: does a slip use nothing that comes later?"""

    estimate: Callable[[Log], Estimates]
    is_causal: bool
    what: str


ENTRANTS: Dict[str, Entrant] = {
    "grouser-online": Entrant(partial(grouser.estimate, is_online=True), True, "grouser estimate --online"),
    "grouser": Entrant(partial(grouser.estimate, is_online=False), False, "grouser estimate: the whole log"),
    "trailing-0.5": Entrant(partial(window_mean, span_s=0.5, is_centred=False), True, "mean over the last 0.5 s"),
    "trailing-1": Entrant(partial(window_mean, span_s=1.0, is_centred=False), True, "mean over the last second"),
    "trailing-2": Entrant(partial(window_mean, span_s=2.0, is_centred=False), True, "mean over the last 2 s"),
    "centred-0.5": Entrant(partial(window_mean, span_s=0.5, is_centred=True), False, "mean over the 0.5 s around"),
    "centred-1": Entrant(partial(window_mean, span_s=1.0, is_centred=True), False, "mean over the second around"),
    "ratio": Entrant(ratio_of_counts, True, "ratio of the counts over 0.25 s (Ani et al. 2012)"),
    "ekf": Entrant(robot_localization, True, "equations and defaults of robot_localization, then the slip"),
}
