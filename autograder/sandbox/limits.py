"""Limits of one submission: time, processor, memory, processes, disk, cells and output."""

from dataclasses import dataclass

from labsid.checks.time_limit import (
    CALL_SECONDS,
    CELL_SECONDS,
    CPU_SECONDS,
    DISK_BYTES,
    FILE_BYTES,
    MEMORY_BYTES,
    MOST_OWN_CELLS,
    OPEN_FILES,
    SUBMISSION_SECONDS,
    THREADS,
)


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one submission.

    Attributes
    ----------
    start_seconds, cell_seconds, call_seconds : float
        Time-outs of starting a process, of one cell, and of one answer (a value or a function call).
    submission_seconds : float
        Time-out of the whole submission, which also bounds many cells that each time out.
    cells : int
        Cells of the student's that are run.
    memory_bytes, file_bytes, disk_bytes : int
        Address space of a process, size of one file, and size of all files (if the isolation level can bound it).
    processes, open_files : int
        Processes and threads beside the first, and open files.
    cpu_seconds : int
        Processor time of a process.
    output_characters : int
        Output of all cells that is kept for the feedback.
    """

    start_seconds: float = 60.0
    cell_seconds: float = CELL_SECONDS
    call_seconds: float = CALL_SECONDS
    submission_seconds: float = SUBMISSION_SECONDS
    cells: int = MOST_OWN_CELLS
    memory_bytes: int = MEMORY_BYTES
    file_bytes: int = FILE_BYTES
    disk_bytes: int = DISK_BYTES
    processes: int = THREADS
    open_files: int = OPEN_FILES
    cpu_seconds: int = CPU_SECONDS
    output_characters: int = 200_000

    def as_rlimits(self, running: int = 0) -> dict[str, int]:
        """The limits that the operating system enforces; RLIMIT_NPROC also counts the user's `running` processes."""
        return {
            "RLIMIT_AS": self.memory_bytes,
            "RLIMIT_FSIZE": self.file_bytes,
            "RLIMIT_NPROC": self.processes + running,
            "RLIMIT_NOFILE": self.open_files,
            "RLIMIT_CPU": self.cpu_seconds,
            "RLIMIT_CORE": 0,
            "RLIMIT_MEMLOCK": 0,
            "RLIMIT_MSGQUEUE": 0,
        }
