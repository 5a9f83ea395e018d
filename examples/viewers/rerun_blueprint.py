"""Writes a Rerun blueprint for recordings of `grouser estimate -o` and `grouser drive -o`.

    pip install rerun-sdk                             # 0.41 or later: plots of any field of a message
    python examples/viewers/rerun_blueprint.py grouser.rbl
    rerun slip.mcap grouser.rbl

`python examples/viewers/rerun_blueprint.py drive.rbl map` is for drives, whose frame is `map`.

The ground where wheels passed, coloured by slip, with the robot; slips with their sigmas, the speed, and the state of each
wheel. Rerun draws no markers: robot and points come from `/grouser/points` and the poses.
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
# Poses of the robot: of an estimate, and the true one of a drive.
POSES = ["/grouser/pose", "/simulation/truth/pose"]
# Half the size of the box that stands for the robot, and the radius of a point on the ground, m.
HALF_SIZE = [0.2, 0.15, 0.05]
POINT_RADIUS = 0.02
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


def ground(frame: str) -> rrb.Spatial3DView:
    """Where the wheels passed up to the cursor, in their colours, and the robot there."""
    colours = VisualizerComponentMapping(
        target="Points3D:colors",
        source_kind=ComponentSourceKind.SourceComponent,
        source_component="Points3D:colour",
    )
    points = rr.Points3D.from_fields(radii=POINT_RADIUS).visualizer(mappings=[colours])
    robot = rr.Boxes3D.from_fields(half_sizes=[HALF_SIZE], colors=[0x59667380])
    until_now = rrb.VisibleTimeRange(
        "message_log_time",
        start=rrb.TimeRangeBoundary.infinite(),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    return rrb.Spatial3DView(
        name="Ground, coloured by slip",
        contents=["/grouser/points", *POSES],
        overrides={
            "/grouser/points": [points, rrb.VisibleTimeRanges([until_now])],
            **{pose: robot for pose in POSES},
        },
        spatial_information=rrb.SpatialInformation(frame),
    )


def main() -> None:
    """Writes the blueprint to the file that the command line names."""
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: rerun_blueprint.py OUT.rbl [FRAME]")
    frame = sys.argv[2] if len(sys.argv) == 3 else "odom"
    plots = [view(*plot) for plot in PLOTS]
    query = rrb.archetypes.DataframeQuery(timeline="message_log_time")
    states = rrb.DataframeView(name="Motion and health", origin="/grouser/slip", query=query)
    blueprint = rrb.Blueprint(rrb.Horizontal(rrb.Vertical(ground(frame), states), rrb.Vertical(*plots)))
    blueprint.save("grouser", sys.argv[1])


if __name__ == "__main__":
    main()
