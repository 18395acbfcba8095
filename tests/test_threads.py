"""Small computations take one thread, whenever and in whatever thread they run; after them others have theirs again."""

import subprocess
import sys

import pytest

SETTING = """
import sys, threading, types
import numpy
from threadpoolctl import threadpool_info, threadpool_limits
from sketchwidget.threads import one_thread

def blas():
    return [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"][0]

threadpool_limits(2, user_api="blas")
"""
TORCH_LOADED_LATER = """
with one_thread():
    assert "torch" not in sys.modules
import torch
torch.set_num_threads(3)
with one_thread():
    print(torch.get_num_threads())
    with one_thread():
        pass
    print(torch.get_num_threads())
print(torch.get_num_threads())
"""
TORCH_BEING_LOADED = """
sys.modules["torch"] = types.ModuleType("torch")
with one_thread():
    pass
del sys.modules["torch"]
import torch
torch.set_num_threads(3)
with one_thread():
    print(torch.get_num_threads(), blas())
print(torch.get_num_threads(), blas())
"""
IN_A_THREAD = """
import torch
torch.set_num_threads(3)

def run():
    with one_thread():
        print(torch.get_num_threads())
    print(torch.get_num_threads())

thread = threading.Thread(target=run)
thread.start()
thread.join()
"""
OVERLAPPING = """
first, second = one_thread(), one_thread()
first.__enter__()
second.__enter__()
first.__exit__(None, None, None)
print(blas())
second.__exit__(None, None, None)
print(blas())
"""
TORCH_FREE = """
import torch
torch.set_num_threads(3)
with one_thread("blas"):
    print(torch.get_num_threads(), blas())
print(torch.get_num_threads(), blas())
"""


@pytest.mark.parametrize(
    ("script", "expected"),
    [
        (TORCH_LOADED_LATER, "1 1 3"),
        (TORCH_BEING_LOADED, "1 1 3 2"),
        (IN_A_THREAD, "1 3"),
        (OVERLAPPING, "1 2"),
        (TORCH_FREE, "3 1 3 2"),
    ],
    ids=["torch loaded later", "torch being loaded", "in a thread", "overlapping", "torch free"],
)
def test_one_thread_is_taken_and_the_others_are_given_back(script, expected):
    run = subprocess.run([sys.executable, "-c", SETTING + script], capture_output=True, text=True)
    assert run.stdout.split() == expected.split(), run.stderr
