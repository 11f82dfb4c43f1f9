"""A focus that circles, by WebSocket: python client.py 'ws://127.0.0.1:PORT/?token=...'."""

import json
import sys
import time
from math import cos, sin

from websockets.sync.client import connect

with connect(sys.argv[1]) as server:
    print(server.recv())
    for step in range(500):
        angle = 0.05 * step
        point = [0.02 * cos(angle), 0.02 * sin(angle), 0.15]
        server.send(json.dumps({"points": [point]}))
        time.sleep(0.01)
    server.send('{"state": true}')
    print(server.recv())
