# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Resources of a process that the soak tests monitor."""

from pathlib import Path


def of_process(pid):
    """Resident memory [MB], threads and open files of a process."""
    status = Path(f"/proc/{pid}/status").read_text()

    def field(name):
        return int(status.split(f"{name}:")[1].split()[0])
    return {"memory_mb": round(field("VmRSS") / 1024, 2), "threads": field("Threads"),
            "files": len(list(Path(f"/proc/{pid}/fd").iterdir()))}
