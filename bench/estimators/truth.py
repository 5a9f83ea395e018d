"""What a log of a row is, what is true in it, and distances from which both are derived."""

import dataclasses
import pathlib

import numpy as np


@dataclasses.dataclass
class WheelRun:
    """True slips of one wheel of one log, each of a window; `naive` has the means that anybody takes from the same readings."""

    wheel: str
    begin_s: np.ndarray
    end_s: np.ndarray  # equal to begin_s where the truth is that of a moment
    slip: np.ndarray
    sigma: np.ndarray  # of the truth
    naive: dict
    high: object = None  # (times, slips over a second, their sigmas) for the row high-slip


@dataclasses.dataclass
class Log:
    """A log on disk: the files, the description of the robot and the columns, the truth, and the rows of the table it counts in."""

    name: str
    rows: tuple
    folder: pathlib.Path
    files: list
    robot: str
    column_map: str | None
    row_count: int
    runs: list
    whole: object = None  # (from_s, to_s, true slip of the whole distance) where a row judges that
    extra: dict = dataclasses.field(default_factory=dict)


def slip_of(wheel, centre):
    """1 - v/(r w) where the wheel is faster, r w/v - 1 where the robot is."""
    wheel, centre = np.broadcast_arrays(np.asarray(wheel, float), np.asarray(centre, float))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(centre) <= np.abs(wheel), 1 - centre / wheel, wheel / centre - 1)


class Distances:
    """Distances of a wheel (radius times angle) and of its centre along its heading, over time."""

    def __init__(self, time_s, wheel, centre):
        self.time_s, self.wheel, self.centre = time_s, wheel, centre

    def between(self, begin_s, end_s):
        wheel = np.interp(end_s, self.time_s, self.wheel) - np.interp(begin_s, self.time_s, self.wheel)
        centre = np.interp(end_s, self.time_s, self.centre) - np.interp(begin_s, self.time_s, self.centre)
        return wheel, centre


def centre_distance(forward, left, turn, place, heading):
    """Distance of a wheel's centre along the wheel's heading, from displacements of the robot in its own frame, summed."""
    x, y = place
    along = np.cos(heading) * (forward - turn * y) + np.sin(heading) * (left + turn * x)
    return np.cumsum(along)


def displacements(x, y, yaw):
    """Displacements between poses, in the frame halfway between them; the first is zero."""
    yaw = np.unwrap(yaw)
    dx, dy, turn = (np.diff(value, prepend=value[0]) for value in (x, y, yaw))
    middle = yaw - 0.5 * turn
    return np.cos(middle) * dx + np.sin(middle) * dy, np.cos(middle) * dy - np.sin(middle) * dx, turn


# Trailing means use readings up to the moment, centred ones as many before as after it.
NAIVE = {"trailing 1 s": (1.0, False), "trailing 2 s": (2.0, False), "centred 1 s": (1.0, True), "centred 2 s": (2.0, True)}


def naive_series(readings, time_s, min_wheel_m, windows=NAIVE):
    """Means of the slip between two readings of the reference, at times; NaN where a wheel has not gone far enough.

    `readings` are Distances at the stamps of the reference.
    """
    found = {}
    for name, (window_s, is_centred) in windows.items():
        half = 0.5 * window_s if is_centred else 0.0
        last = np.searchsorted(readings.time_s, time_s + half + 1e-6, side="right") - 1
        ends_s = readings.time_s[np.maximum(last, 0)]
        if is_centred:
            ends_s = np.minimum(ends_s, time_s + half)
        first = np.searchsorted(readings.time_s, ends_s - window_s + 1e-6, side="right") - 1
        is_known = (last >= 0) & (first >= 0) & (first < last) & (time_s + half <= readings.time_s[-1] + 1e-6)
        last, first = np.maximum(last, 0), np.maximum(first, 0)
        wheel = readings.wheel[last] - readings.wheel[first]
        slip = np.clip(slip_of(wheel, readings.centre[last] - readings.centre[first]), -1, 1)
        found[name] = np.where(is_known & (np.abs(wheel) > min_wheel_m), slip, np.nan)
    return found


def over_windows(time_s, values, begin_s, end_s):
    """Means of a series over windows; NaN where it has no value in a window. Windows of no length: the value at or before."""
    is_value = np.isfinite(values)
    time_s, values = np.asarray(time_s)[is_value], np.asarray(values)[is_value]
    if not len(time_s):
        return np.full(len(begin_s), np.nan)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    first = np.searchsorted(time_s, begin_s - 1e-6)
    last = np.searchsorted(time_s, end_s + 1e-6, side="right")
    count = last - first
    mean = np.where(count > 0, (sums[last] - sums[first]) / np.maximum(count, 1), np.nan)
    before = np.maximum(last - 1, 0)
    held = np.where((last > 0) & (end_s - time_s[before] <= MAX_AGE_S), values[before], np.nan)
    return np.where(end_s - begin_s < 1e-9, held, mean)


MAX_AGE_S = 0.3  # a value of a moment is at most this old, as in bench/random_logs.py


def sliding(distances, from_s, to_s, span_s, min_wheel_m, step_s=0.1):
    """Windows of a span each step: begins, ends, true slips, distances of wheel and centre; those without a distance left out."""
    middle = np.arange(from_s, to_s + 1e-9, step_s)
    begin_s, end_s = middle - 0.5 * span_s, middle + 0.5 * span_s
    wheel, centre = distances.between(begin_s, end_s)
    is_far = np.abs(wheel) > min_wheel_m
    return begin_s[is_far], end_s[is_far], slip_of(wheel, centre)[is_far], wheel[is_far], centre[is_far]


def write_table(path, columns):
    names = list(columns)
    with path.open("w") as out:
        out.write(",".join(names) + "\n")
        for row in zip(*columns.values()):
            out.write(",".join(row) + "\n")


def text(values, digits):
    return ["" if value != value else f"{value:.{digits}f}" for value in values]


def write_map(path, columns, time="t", unit="s"):
    """A column map of one table. Columns: (column, meaning, unit, wheel or None)."""
    lines = ["format = 1", "[[table]]", f'time = {{ column = "{time}", unit = "{unit}" }}', "columns = ["]
    for column, meaning, column_unit, wheel in columns:
        of_wheel = f', wheel = "{wheel}"' if wheel else ""
        lines.append(f'{{ column = "{column}", meaning = "{meaning}"{of_wheel}, unit = "{column_unit}" }},')
    path.write_text("\n".join(lines + ["]"]) + "\n")
