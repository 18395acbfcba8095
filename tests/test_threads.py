"""Small computations take one thread, whenever what computes was loaded."""

import subprocess
import sys

LOADED_LATER = """
import sys
from sketchwidget.threads import one_thread
with one_thread():
    assert "torch" not in sys.modules
import torch
torch.set_num_threads(3)
print(torch.get_num_threads())
with one_thread():
    print(torch.get_num_threads())
    with one_thread():
        pass
    print(torch.get_num_threads())
print(torch.get_num_threads())
"""


def test_torch_takes_one_thread_though_it_was_loaded_later_and_has_its_own_again():
    run = subprocess.run([sys.executable, "-c", LOADED_LATER], capture_output=True, text=True)
    assert run.stdout.split() == ["3", "1", "1", "3"], run.stderr
