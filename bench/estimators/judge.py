"""Figures of an estimator: of one log, and of a row of logs."""

import math

import numpy as np

from truth import over_windows

Z_90 = 1.645
# High slip is shown where the 90 % bound (one-sided, 1.28 sigma) is above 0.6 for a second.
HIGH_SLIP, HIGH_SPAN_S, SHOWN_SPAN_S, SHOWN_Z = 0.6, 3.0, 1.0, 1.28


def interval_score(half, error):
    """Of a 90 % interval: its width and 20 times what the truth is outside of it (Gneiting and Raftery 2007)."""
    return 2 * half + 20 * np.maximum(np.abs(error) - half, 0)


def of_log(log, series):
    """For each wheel run: squared errors of the entrant and of the naive means, share held, score, half-widths."""
    found = []
    for run in log.runs:
        known = np.isfinite(run.slip)
        for values in run.naive.values():
            known &= np.isfinite(values)
        if run.wheel in series:
            time_s, slip, *others = series[run.wheel]
            others = [np.where(np.isfinite(slip), values, np.nan) for values in others]
            slip, sigma, ok = (over_windows(time_s, values, run.begin_s, run.end_s) for values in (slip, *others))
        else:
            slip = sigma = ok = np.full(len(run.slip), np.nan)
        answered = known & np.isfinite(slip)
        if not known.any():
            continue
        error = (slip - run.slip)[answered]
        one = {"points": int(known.sum()), "answered": int(answered.sum()), "errors": error}
        one["naive"] = {key: (values - run.slip)[answered] for key, values in run.naive.items()}
        has_sigma = np.isfinite(sigma[answered])
        half = Z_90 * np.hypot(sigma[answered], run.sigma[answered])[has_sigma]
        one["held"] = np.abs(error[has_sigma]) <= half
        one["score"] = interval_score(half, error[has_sigma])
        one["half"] = Z_90 * sigma[answered][has_sigma]
        one["slips"], one["is_ok"] = slip[answered], ok[answered] > 0.5
        found.append(one)
    return found


def longest_start(time_s, is_on, span_s):
    """Begin and end of the first stretch that is on for a span, or None."""
    began = None
    for t, on in zip(time_s, is_on):
        began = (t if began is None else began) if on else None
        if on and t - began >= span_s - 1e-6:
            later = [other for other, is_it in zip(time_s, is_on) if other > t and not is_it]
            return began, (later[0] if later else time_s[-1])
    return None


def high_slip(log, series):
    """Of each wheel run: begin of a true slip above 0.6 for 3 s or None, time until it is shown or None, and whether falsely shown."""
    found = []
    for run in log.runs:
        if run.high is None:
            continue
        at_s, true, true_sigma = run.high
        stretch = longest_start(at_s, true > HIGH_SLIP, HIGH_SPAN_S)
        after_s, is_false = None, False
        if run.wheel in series:
            time_s, slip, sigma, _ = series[run.wheel]
            is_shown = np.nan_to_num(slip - SHOWN_Z * sigma, nan=-1) > HIGH_SLIP
            began = None
            for t, on in zip(time_s, is_shown):
                began = (t if began is None else began) if on else None
                if not on or t - began < SHOWN_SPAN_S:
                    continue
                if stretch and stretch[0] <= t <= stretch[1] + SHOWN_SPAN_S and after_s is None:
                    after_s = t - stretch[0]
                inside = (at_s >= t - SHOWN_SPAN_S) & (at_s <= t)
                if inside.any() and np.mean((true + Z_90 * true_sigma)[inside]) < HIGH_SLIP:
                    is_false = True
        found.append({"is_high": stretch is not None, "after_s": after_s, "is_false": is_false})
    return found


def root_mean(values):
    return math.sqrt(np.mean(np.square(values))) if len(values) else math.nan


def of_row(row, results):
    """Figures of a row from its logs' results: dictionaries with `runs`, `spent_s`, `row_count`, `failure`, `high`, `whole`.

    `rmse` is the mean over wheel runs of each one's root mean square error, `ratio` that over the same of the better naive mean;
    of random logs the geometric mean over logs of the ratios.
    """
    runs = [run for result in results for run in result["runs"] if run["answered"]]
    figures = {"logs": len(results), "failed": sum(bool(result["failure"]) for result in results)}
    figures["points"] = sum(run["points"] for result in results for run in result["runs"])
    figures["answered"] = sum(run["answered"] for run in runs)
    figures["cpu_s"] = sum(result["spent_s"] for result in results)
    figures["rows_per_s"] = sum(result["row_count"] for result in results) / max(figures["cpu_s"], 1e-3)
    if row.startswith("high-slip"):
        return figures | of_high_slip([one for result in results for one in result["high"]])
    if not runs:
        return figures
    figures["rmse"] = float(np.mean([root_mean(run["errors"]) for run in runs]))
    mean_of = lambda key: float(np.mean([root_mean(run["naive"][key]) for run in runs]))
    for kind in ("trailing", "centred"):
        keys = [key for key in runs[0]["naive"] if key.startswith(kind)]
        if keys:
            better = min(mean_of(key) for key in keys)
            figures[kind] = better
            figures[f"over_{kind}"] = figures["rmse"] / better
    if row.startswith("random"):
        figures["over_trailing"] = geometric_ratio(results)
    joined = lambda key: np.concatenate([run[key] for run in runs])
    if len(joined("held")):
        figures["held"] = float(joined("held").mean())
        figures["score"] = float(joined("score").mean())
        figures["half"] = float(np.median(joined("half")))
    if row == "plaza":
        figures["p5"], figures["p95"] = (float(value) for value in np.percentile(joined("slips"), [5, 95]))
    ok = joined("is_ok")
    figures["ok"] = float(ok.mean())
    figures["ok_rmse"] = float(np.mean([root_mean(run["errors"][run["is_ok"]]) for run in runs if run["is_ok"].any()] or [math.nan]))
    # the loop's own estimates at the same points, where their health is Ok, as the figure that `drive` prints
    loops = [result["extra"]["loop"] for result in results if "loop" in result["extra"]]
    if loops:
        figures["loop"] = float(np.mean(loops))
        figures["over_loop"] = figures["rmse"] / figures["loop"]
    wholes = [result["whole"] for result in results if result["whole"] is not None]
    if wholes:
        figures["whole"] = wholes[0]
    return figures


def geometric_ratio(results):
    ratios = []
    for result in results:
        runs = [run for run in result["runs"] if run["answered"]]
        if runs:
            joined = lambda values: root_mean(np.concatenate(list(values)))
            better = min(joined(run["naive"][key] for run in runs) for key in runs[0]["naive"])
            ratios.append(joined(run["errors"] for run in runs) / better)
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else math.nan


def of_high_slip(found):
    high = [one for one in found if one["is_high"]]
    shown = [one["after_s"] for one in high if one["after_s"] is not None]
    figures = {"wheel_runs": len(found), "high": len(high), "shown": len(shown)}
    figures["shown_in_3_s"] = sum(after <= 3.0 for after in shown)
    figures["false"] = sum(one["is_false"] for one in found)
    if shown:
        figures["median_after_s"] = float(np.median(shown))
    return figures


def whole_slip(log, series):
    """Slip of the whole distance from slips over time, each weighed by the wheel's distance."""
    if log.whole is None or log.runs[0].wheel not in series:
        return None
    time_s, slip, *_ = series[log.runs[0].wheel]
    is_known = np.isfinite(slip)
    steps = np.abs(np.diff(np.interp(time_s[is_known], log.extra["time_s"], log.extra["wheel_m"])))
    return float((steps * slip[is_known][1:]).sum() / steps.sum())
