"""A button in the air by Leap: python leap.py 'ws://127.0.0.1:PORT/?token=...' [ws://127.0.0.1:6437/v6.json].

The Leap lies at LEAP, its long side along x, and looks along z. Ultraleap's program
UltraleapTrackingWebSocket serves its frames.
"""

import json
import sys
from math import hypot

from websockets.sync.client import connect

#: Place of the Leap in m of the array.
LEAP = (0.0, -0.12, 0.0)


def palm(frame):
    """Returns the palm's place in m of the array, None without a hand.

    The Leap's y points up, its z towards the user.
    """
    if not frame["hands"]:
        return None
    x, y, z = (1e-3 * each for each in frame["hands"][0]["palmPosition"])
    return [LEAP[0] + x, LEAP[1] - z, LEAP[2] + y]


def message(point):
    """Returns the message for a palm: a disc of 3 cm radius is felt from 13 to 17 cm above the array."""
    felt = point and hypot(point[0], point[1]) < 0.03 and 0.13 < point[2] < 0.17
    return json.dumps({"points": [point]} if felt else {"off": True})


service = sys.argv[2] if len(sys.argv) > 2 else "ws://127.0.0.1:6437/v6.json"
with connect(sys.argv[1]) as server, connect(service) as leap:
    server.send('{"modulation": 200}')
    # Without spaces: frames also while another program has the focus.
    leap.send('{"background":true}')
    for text in leap:
        frame = json.loads(text)
        if "hands" in frame:
            server.send(message(palm(frame)))
