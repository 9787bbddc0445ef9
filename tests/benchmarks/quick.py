"""The benchmarks in brief, with what they start from a launcher if this process is from one.

Run ``python -m tests.benchmarks.quick PART... --output FILE``.
"""

import os
import subprocess
import sys

from benchmarks.__main__ import main

from cartwheel.bridges.apart import process

# In a process from a launcher, bridge processes start from it.
vars(subprocess)["Popen"] = process.Popen
# It starts no processes with variables that a library reads when it is imported.
os.environ.pop("MUJOCO_GL")

if __name__ == "__main__":
    sys.argv.append("--quick")
    main()
