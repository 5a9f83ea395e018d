"""Writes the logs beside this script with rosbags 0.11.9 and mcap-ros2-support 0.6.0 (mcap 1.6.0)."""
import math
import sys
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_typestore

OUT = Path(sys.argv[1])
COUNT = 40
NAMES = ["left", "right"]
DEFINITION = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
"""


def position(k):
    return [math.sqrt(k), -1.0 / (k + 1)]


def stamp(k):
    return 1_700_000_000_000_000_000 + 20_000_000 * k


for name, kind in [("none", CompressionType.NONE), ("lz4", CompressionType.LZ4), ("zstd", CompressionType.ZSTD)]:
    with open(OUT / f"joints_{name}.mcap", "wb") as f:
        w = Writer(f, compression=kind, chunk_size=1024)
        schema = w.register_msgdef("sensor_msgs/msg/JointState", DEFINITION)
        for k in range(COUNT):
            t = stamp(k)
            w.write_message("/joint_states", schema, {
                "header": {"stamp": {"sec": t // 10**9, "nanosec": t % 10**9}, "frame_id": "base"},
                "name": NAMES, "position": position(k), "velocity": [0.1 * k], "effort": [],
            }, log_time=t, publish_time=t, sequence=k)
        w.finish()

store = get_typestore(Stores.ROS1_NOETIC)
Joint, Header = store.types["sensor_msgs/msg/JointState"], store.types["std_msgs/msg/Header"]
Time = store.types["builtin_interfaces/msg/Time"]
for name in ["none", "bz2", "lz4"]:
    path = OUT / f"joints_{name}.bag"
    path.unlink(missing_ok=True)
    w = Writer1(path)
    if name != "none":
        w.set_compression(Writer1.CompressionFormat[name.upper()])
    w.chunk_threshold = 1024
    with w:
        conn = w.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for k in range(COUNT):
            t = stamp(k)
            m = Joint(Header(k, Time(t // 10**9, t % 10**9), "base"), NAMES,
                      np.array(position(k)), np.array([0.1 * k]), np.array([]))
            w.write(conn, t, store.serialize_ros1(m, "sensor_msgs/msg/JointState"))
