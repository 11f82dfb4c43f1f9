"""Set before NumPy is imported: BLAS threads that wait by spinning make busy machines crawl."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
