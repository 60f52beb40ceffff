"""Renders thumbnails of many models in a pool of processes: thumbnails.py FOLDER MODEL...

Processes must be spawned, since forked ones lack the threads of the library. The cores are divided among them.
"""
import multiprocessing
import os
import sys
from typing import Tuple

import umbrage

SIZE = (256, 256)


def thumbnail(job: Tuple[str, str, int]) -> str:
    """Renders one model. Returns a line with the file name or the error."""
    model, folder, threads = job
    name = os.path.basename(model.split("?")[0]).replace("scene:", "")
    target = os.path.join(folder, os.path.splitext(name)[0] + ".png")
    try:
        umbrage.render(model, size=SIZE, quality="draft", device="cpu", threads=threads, transparent=True).save(target)
    except umbrage.UmbrageError as error:
        return f"{model}: {error} (code {error.code})"
    return f"{model}: {target}"


def main() -> int:
    folder, models = sys.argv[1], sys.argv[2:]
    os.makedirs(folder, exist_ok=True)
    cores = os.cpu_count() or 1
    processes = max(1, min(len(models), cores // 2))
    jobs = [(model, folder, max(1, cores // processes)) for model in models]
    failed = 0
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for line in pool.imap_unordered(thumbnail, jobs):
            print(line)
            failed += "(code " in line
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
