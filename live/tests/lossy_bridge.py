"""Frames between two network interfaces, of which a share is lost: a kernel without `netem` has no other way.

Called as: lossy_bridge.py A B    a share from 0 to 1 on each line of standard input; prints a line when it is in force
           lossy_bridge.py --plain A    checksums are computed and frames cut by software, so that they can be copied
"""

import fcntl
import random
import select
import socket
import struct
import sys

SIOCETHTOOL = 0x8946
# ETHTOOL_STXCSUM, STSO, SGSO, SGRO
OFFLOADS = (0x17, 0x1F, 0x24, 0x2C)
PACKET_OUTGOING = 4
ALL_FRAMES = 3


def plain(name):
    import array

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        for command in OFFLOADS:
            value = array.array("B", struct.pack("II", command, 0))
            request = struct.pack("16sP", name.encode(), value.buffer_info()[0])
            fcntl.ioctl(control, SIOCETHTOOL, request)


def bridge(names):
    sockets = []
    for name in names:
        frames = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ALL_FRAMES))
        frames.bind((name, 0))
        sockets.append(frames)
    loss, chance = 0.0, random.Random(2012)
    while True:
        for ready in select.select([*sockets, sys.stdin], [], [])[0]:
            if ready is sys.stdin:
                line = sys.stdin.readline()
                if not line:
                    return
                loss = float(line)
                print(loss, flush=True)
                continue
            frame, address = ready.recvfrom(65536)
            if address[2] != PACKET_OUTGOING and chance.random() >= loss:
                other = sockets[1 - sockets.index(ready)]
                try:
                    other.send(frame)
                except OSError:
                    pass  # the other side is full or gone: the frame is lost


if __name__ == "__main__":
    if sys.argv[1] == "--plain":
        plain(sys.argv[2])
    else:
        bridge(sys.argv[1:3])
