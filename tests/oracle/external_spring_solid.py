#!/usr/bin/python3
"""A solid server that shares no line with Couplet: a square of four nodes, each a mass on a spring, m u'' + k u = f.
The force is constant within a step, so u(t) = f/k + (u0 - f/k) cos(w t) + v0/w sin(w t) with w = sqrt(k/m).
Usage: external_spring_solid.py [ADDRESS]. Written from proto/README.md; it trusts the coupler to keep to the state table."""
import os, pathlib, resource, subprocess, sys, tempfile, time
import numpy as np
import zmq

schema = pathlib.Path(__file__).resolve().parents[2] / "proto"
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["protoc", "-I", schema, "--python_out", folder, *schema.glob("couplet/v1/*.proto")], check=True)
    sys.path.insert(0, folder)
    from couplet.v1 import exchange_pb2 as v1

MASS, STIFFNESS = 2.0, 50.0  # [kg], [N/m]
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)  # [m]
TYPES = {"f": v1.ArrayHeader.FLOAT64, "i": v1.ArrayHeader.INT64}

def crc32c(data):  # bit by bit, enough for four nodes; for many take a table or a library
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x82F63B78 * (crc & 1)
    return crc ^ 0xFFFFFFFF

def answer(request, frames):
    global accepted, trial
    reply, arrays, offered = v1.Reply(sequence=request.sequence), [], ["displacement", "velocity"]
    match request.WhichOneof("body"):
        case "hello":
            reply.welcome.protocol, reply.welcome.program = 1, "external_spring_solid"
        case "open_scene":
            if request.open_scene.resume_from:
                accepted = trial = np.load(request.open_scene.resume_from)
            ready = v1.SceneReady(needs=["force"], offers=offered, surface={"region": ["top"]})
            ready.surface.marker.add(name="corner", node=2)
            reply.scene_ready.CopyFrom(ready)
            arrays = [("node_position", SQUARE), ("face_offset", np.array([0, 4])), ("face_node", np.arange(4)),
                      ("face_region", np.array([0])), *zip(offered, trial)]
        case "solve_step":
            i = [header.name for header in request.array].index("force")
            assert crc32c(frames[1 + i]) == request.array[i].crc32c, "damaged on its way"
            rest = np.frombuffer(frames[1 + i]).reshape(request.array[i].shape) / STIFFNESS
            u, v, w = *accepted, np.sqrt(STIFFNESS / MASS)
            c, s = np.cos(w * request.solve_step.duration), np.sin(w * request.solve_step.duration)
            trial = np.array([rest + (u - rest) * c + v / w * s, (rest - u) * w * s + v * c])
            reply.step_solved.seconds = 0
            arrays = zip(offered, trial)
        case "accept_step":
            accepted = trial
            reply.step_accepted.quantity.add(name="kinetic_energy", unit="J", value=MASS / 2 * (trial[1] ** 2).sum())
        case "write_checkpoint":
            with open(request.write_checkpoint.path, "wb") as file:
                np.save(file, accepted)
            reply.checkpoint_written.bytes = os.path.getsize(request.write_checkpoint.path)
        case "close":
            reply.closed.quantity.add(name="seconds", unit="s", value=time.process_time())
            reply.closed.quantity.add(name="peak_memory_bytes", unit="1",
                                      value=1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    blocks = []
    for name, array in arrays:
        blocks.append(array.tobytes())
        reply.array.add(name=name, scalar_type=TYPES[array.dtype.kind], shape=array.shape, crc32c=crc32c(blocks[-1]))
    return [reply.SerializeToString(), *blocks]

accepted = trial = np.zeros((2, 4, 3))  # displacement [m] and velocity [m/s] of four nodes
last, kept, coupler = 0, [], None
socket = zmq.Context().socket(zmq.ROUTER)
socket.bind(sys.argv[1] if len(sys.argv) > 1 else "tcp://127.0.0.1:*")
print("listening", socket.getsockopt_string(zmq.LAST_ENDPOINT), flush=True)
while not kept or not v1.Reply.FromString(kept[0]).HasField("closed"):
    if not socket.poll(600_000):  # [ms]
        sys.exit("the coupler is lost")
    sender, *frames = socket.recv_multipart()
    coupler = coupler or sender
    request = v1.Request.FromString(frames[0])
    if sender == coupler and request.sequence in (last, last + 1):
        if request.sequence > last:  # a repeat is answered by the kept reply
            kept, last = answer(request, frames), request.sequence
        socket.send_multipart([sender, *kept])
