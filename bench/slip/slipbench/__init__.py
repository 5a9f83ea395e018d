"""A benchmark of wheel slip estimators.

A *world* makes a `Run`: the log of a robot with the slip that was true. An *entrant* is a function from a `Log` to
`Estimates`: slips with 90 % intervals. `slipbench.score` compares both, `python -m slipbench` makes the table.

    from slipbench import Estimates, Log, Series

    def entrant(log: Log) -> Estimates:
        return {wheel.name: Series(times, slips, lows, highs) for wheel in log.robot.powered}
"""

from slipbench.log import Estimates, Floats, Link, Log, Reference, Robot, Run, Series, Truth, Wheel, slip_of

__all__ = ["Estimates", "Floats", "Link", "Log", "Reference", "Robot", "Run", "Series", "Truth", "Wheel", "slip_of"]
