"""Writes joints.db3 beside this script, as rosbag2 of ROS 2 Humble writes it, with the sqlite3 of Python."""
import math
import sqlite3
import struct
import sys
from pathlib import Path

PATH = Path(sys.argv[1]) / "joints.db3"
COUNT = 40


def joints(k):
    t = 1_700_000_000_000_000_000 + 20_000_000 * k
    data = bytearray()

    def put(form, *values):
        size = struct.calcsize("<" + form[-1])
        data.extend(bytes(-len(data) % size))
        data.extend(struct.pack("<" + form, *values))

    def text(word):
        put("I", len(word) + 1)
        data.extend(word.encode() + b"\0")

    put("iI", t // 10**9, t % 10**9)
    text("base")
    put("I", 2)
    text("left")
    text("right")
    for numbers in ([math.sqrt(k), -1.0 / (k + 1)], [0.1 * k], []):
        put("I", len(numbers))
        for number in numbers:
            put("d", number)
    return t, b"\0\1\0\0" + bytes(data)


PATH.unlink(missing_ok=True)
base = sqlite3.connect(PATH)
# small pages: a tree of three levels, and rows over several pages
base.execute("PRAGMA page_size = 512")
base.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL)")
base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
             "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)")
base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, "
             "data BLOB NOT NULL)")
base.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
base.execute("INSERT INTO schema VALUES(3, 'humble')")
base.execute("INSERT INTO topics VALUES(1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr', '')")
base.execute("INSERT INTO topics VALUES(2, '/notes', 'std_msgs/msg/String', 'cdr', '')")
for k in range(COUNT):
    t, data = joints(k)
    base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)", (t, data))
    if k == 20:
        note = b"soft ground. " * 200
        note = b"\0\1\0\0" + struct.pack("<I", len(note) + 1) + note + b"\0"
        base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(2, ?, ?)", (t, note))
base.commit()
base.close()
