"""What one submission may use: time, processor, memory, processes, disk, cells and output."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """What one submission may use.

    Attributes
    ----------
    start_seconds, cell_seconds, call_seconds : float
        Time for the process to come up, for one cell, and for one answer (a value or a call of a function).
    submission_seconds : float
        Time for everything together, so that time-outs spread over many cells end too.
    cells : int
        Cells that are run.
    memory_bytes, file_bytes, disk_bytes : int
        Address space of a process, the size of any one file, and of all files together (where the level can hold that).
    processes, open_files : int
        Processes and threads beside the first, and open files.
    cpu_seconds : int
        Processor time of a process.
    output_characters : int
        What all cells together may print for the feedback.
    """

    start_seconds: float = 60.0
    cell_seconds: float = 30.0
    call_seconds: float = 10.0
    submission_seconds: float = 300.0
    cells: int = 1000
    memory_bytes: int = 2 * 1024**3
    file_bytes: int = 64 * 1024**2
    disk_bytes: int = 128 * 1024**2
    processes: int = 64
    open_files: int = 256
    cpu_seconds: int = 300
    output_characters: int = 200_000

    def as_rlimits(self, running: int = 0) -> dict[str, int]:
        """The limits that the operating system keeps; `running` processes of the same user count too."""
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
