"""The C interface from Python, with nothing but ctypes.

    ctypes_test.py LIBRARY SCENE
"""

import ctypes as C
import sys
import threading

library, scene_file = sys.argv[1:3]
cvt = C.CDLL(library)


class Message(C.Structure):
    _fields_ = [("size", C.c_uint32), ("code", C.c_int32), ("text", C.c_char * 1016)]


class Options(C.Structure):
    _fields_ = [("size", C.c_uint32), ("way", C.c_int32), ("threads", C.c_int32), ("segments", C.c_int32)]


Output = C.CFUNCTYPE(C.c_int, C.c_void_p, C.c_void_p)
double_pointer = C.POINTER(C.c_double)
for name, result, arguments in [
    ("cvtflow_version", C.c_char_p, []),
    ("cvtflow_time", C.c_double, [C.c_void_p]),
    ("cvtflow_hash", C.c_uint64, [C.c_void_p]),
    ("cvtflow_size", C.c_size_t, [C.c_void_p]),
    ("cvtflow_unknowns", double_pointer, [C.c_void_p]),
    ("cvtflow_advance_to", C.c_int, [C.c_void_p, C.c_double, C.POINTER(Message)]),
    ("cvtflow_cancel", None, [C.c_void_p]),
    ("cvtflow_destroy", None, [C.c_void_p]),
    ("cvtflow_scene_release", None, [C.c_void_p]),
    ("cvtflow_on_output", C.c_int, [C.c_void_p, C.c_double, Output, C.c_void_p, C.POINTER(Message)]),
    ("cvtflow_input_set", C.c_int, [C.c_void_p, C.c_int32, C.c_double, C.POINTER(Message)]),
    ("cvtflow_state_get", C.c_int, [C.c_void_p, C.c_void_p, C.POINTER(C.c_size_t), C.POINTER(Message)]),
    ("cvtflow_state_set", C.c_int, [C.c_void_p, C.c_void_p, C.c_size_t, C.POINTER(Message)]),
    ("cvtflow_channel_find", C.c_int, [C.c_void_p, C.c_char_p, C.POINTER(C.c_size_t), C.POINTER(Message)]),
    ("cvtflow_channel_values", C.c_int, [C.c_void_p, C.c_size_t, C.POINTER(double_pointer), C.POINTER(C.c_size_t), C.POINTER(Message)]),
]:
    function = getattr(cvt, name)
    function.restype, function.argtypes = result, arguments

OK, CANCELLED, SCENE = 0, 7, 2


def message():
    return Message(C.sizeof(Message))


def must(code, said):
    assert code == OK, (code, said.text.decode())


said = message()
scene, brief = C.c_void_p(), C.c_void_p()
must(cvt.cvtflow_scene_read(scene_file.encode(), C.byref(scene), C.byref(said)), said)
settings = (C.c_char_p * 3)(b"start.settling_time=0.3 ms", b"start.ramp_time=0.3 ms", b"run.step=100 ns")
must(cvt.cvtflow_scene_with(scene, settings, C.c_size_t(3), C.byref(brief), C.byref(said)), said)
assert cvt.cvtflow_scene_read(b"/nowhere.toml", C.byref(C.c_void_p()), C.byref(said)) == SCENE
assert b"/nowhere.toml" in said.text


def create(way, threads):
    simulation = C.c_void_p()
    must(cvt.cvtflow_create(brief, C.byref(Options(C.sizeof(Options), way, threads, 0)), C.byref(simulation), C.byref(said)), said)
    return simulation.value


# The same bits on the caller alone and on two threads.
alone, pair = create(0, 1), create(2, 2)
for simulation in (alone, pair):
    must(cvt.cvtflow_advance_to(simulation, -2.8e-4, C.byref(said)), said)
assert cvt.cvtflow_hash(alone) == cvt.cvtflow_hash(pair)

# A state as Python bytes.
size = C.c_size_t()
must(cvt.cvtflow_state_get(alone, None, C.byref(size), C.byref(said)), said)
state = C.create_string_buffer(size.value)
must(cvt.cvtflow_state_get(alone, state, C.byref(size), C.byref(said)), said)
must(cvt.cvtflow_advance_to(alone, -2.7e-4, C.byref(said)), said)
kept = bytes(state)
must(cvt.cvtflow_state_set(pair, kept, len(kept), C.byref(said)), said)
must(cvt.cvtflow_advance_to(pair, -2.7e-4, C.byref(said)), said)
assert cvt.cvtflow_hash(alone) == cvt.cvtflow_hash(pair)


# A callback in Python, with threads of the library behind it: it runs on this thread.
def on_output(simulation, user):
    calls.append((cvt.cvtflow_time(simulation), threading.get_ident()))
    return 0


calls = []
callback = Output(on_output)
must(cvt.cvtflow_on_output(pair, 1e-5, callback, None, C.byref(said)), said)
must(cvt.cvtflow_advance_to(pair, -2.4e-4, C.byref(said)), said)
assert len(calls) == 3 and {ident for _, ident in calls} == {threading.get_ident()}, calls

# Channels and unknowns without copies.
channel, width, values = C.c_size_t(), C.c_size_t(), double_pointer()
must(cvt.cvtflow_channel_find(pair, b"links/tension", C.byref(channel), C.byref(said)), said)
must(cvt.cvtflow_channel_values(pair, channel, C.byref(values), C.byref(width), C.byref(said)), said)
assert width.value == 24 and all(abs(values[k]) < 1e6 for k in range(24))
assert cvt.cvtflow_unknowns(pair)[0] != 0.0 and cvt.cvtflow_size(pair) > 500

# Two simulations on two threads of Python; one is cancelled.
must(cvt.cvtflow_on_output(pair, 1.0, Output(0), None, C.byref(said)), said)
codes = {}
thread = threading.Thread(target=lambda: codes.update(pair=cvt.cvtflow_advance_to(pair, 10.0, None)))
thread.start()
must(cvt.cvtflow_advance_to(alone, -2.6e-4, C.byref(said)), said)
cvt.cvtflow_cancel(pair)
thread.join()
assert codes["pair"] == CANCELLED

for simulation in (alone, pair):
    cvt.cvtflow_destroy(simulation)
cvt.cvtflow_scene_release(brief)
cvt.cvtflow_scene_release(scene)
print("ctypes:", cvt.cvtflow_version().decode())
