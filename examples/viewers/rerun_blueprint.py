"""Writes a Rerun blueprint for recordings of `grouser estimate -o slip.mcap`.

    pip install rerun-sdk                             # 0.41 or later: plots of any field of a message
    python examples/viewers/rerun_blueprint.py grouser.rbl
    rerun slip.mcap grouser.rbl

Slips with their sigmas, the speed, and the state of each wheel. The way coloured by slip (`/grouser/way`) is a marker,
which Rerun shows as a table only: it is drawn by Foxglove and Lichtblick (foxglove.json).
"""

import sys

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

# Topics and their message types, as the recording names them.
TYPES = {
    "/grouser/slip": "grouser_msgs.msg.WheelSlip",
    "/grouser/odom": "nav_msgs.msg.Odometry",
}
# Each plot: its name, its range, and the fields that it shows.
PLOTS = [
    (
        "Slip of each wheel",
        (-1.0, 1.0),
        [
            "/grouser/slip.slip[0]",
            "/grouser/slip.slip[1]",
            "/grouser/slip.slip[2]",
            "/grouser/slip.slip[3]",
            "/grouser/slip.slip[4]",
            "/grouser/slip.slip[5]",
        ],
    ),
    (
        "Sigma of each slip",
        None,
        [
            "/grouser/slip.slip_sigma[0]",
            "/grouser/slip.slip_sigma[1]",
            "/grouser/slip.slip_sigma[2]",
            "/grouser/slip.slip_sigma[3]",
            "/grouser/slip.slip_sigma[4]",
            "/grouser/slip.slip_sigma[5]",
        ],
    ),
    ("Forward speed, m/s", None, ["/grouser/odom.twist.twist.linear.x"]),
    ("Place, m", None, ["/grouser/odom.pose.pose.position.x", "/grouser/odom.pose.pose.position.y"]),
]


def visualizer(path: str) -> tuple[str, rrb.Visualizer]:
    """The topic of a field, and the line that shows it."""
    topic, field = path.split(".", 1)
    scalar = VisualizerComponentMapping(
        target="Scalars:scalars",
        source_kind=ComponentSourceKind.SourceComponent,
        source_component=f"{TYPES[topic]}:message",
        selector=f".{field}",
    )
    return topic, rr.SeriesLines(names=field).visualizer(mappings=[scalar])


def view(name: str, bounds: tuple[float, float] | None, fields: list[str]) -> rrb.TimeSeriesView:
    """One plot."""
    lines: dict[str, list[rrb.Visualizer]] = {}
    for topic, line in map(visualizer, fields):
        lines.setdefault(topic, []).append(line)
    axis = rrb.ScalarAxis(range=bounds) if bounds else None
    return rrb.TimeSeriesView(name=name, contents=list(lines), overrides=lines, axis_y=axis)


def main() -> None:
    """Writes the blueprint to the file that the command line names."""
    if len(sys.argv) != 2:
        sys.exit("usage: rerun_blueprint.py OUT.rbl")
    plots = [view(*plot) for plot in PLOTS]
    states = rrb.DataframeView(name="Motion and health", origin="/grouser/slip")
    rrb.Blueprint(rrb.Vertical(*plots, states)).save("grouser", sys.argv[1])


if __name__ == "__main__":
    main()
